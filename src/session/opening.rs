//! Maps read in the background, and the system's file dialog off the window's thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::file::SessionFile;
use super::{Message, Offer};
use crate::export::lobes_exr::{self, FittedLobes};
use crate::filter::PlainMip;
use crate::filter::vmf::{Monitor, color};
use crate::image_io;
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::normal_map::{DecodeError, Diagnosis, MapOptions, MapSource, NormalMap, OpenError, procedural};
use crate::scene::import::{self, TextureRole};

/// A map to open.
#[derive(Clone, Debug, PartialEq)]
pub enum MapRequest {
    /// A file.
    File {
        /// Where it is.
        path: PathBuf,
        /// How it is read.
        options: MapOptions,
    },
    /// A bundled map.
    Bundled {
        /// Its name.
        name: String,
        /// How it is addressed; the rest does not apply.
        options: MapOptions,
    },
    /// Bytes that were dropped on the window without a path.
    Bytes {
        /// The name they came with.
        name: String,
        /// The file's contents.
        bytes: Arc<[u8]>,
        /// How they are read.
        options: MapOptions,
    },
    /// The map of a session, and its settings with it.
    Session(Box<SessionFile>),
}

/// A map that was read, its lobes where the file holds a fit, and settings where it is a session.
#[derive(Clone, Debug)]
pub struct OpenedMap {
    /// The map.
    pub map: Arc<NormalMap>,
    /// The fit of it that came along.
    pub fit: Option<FittedLobes>,
    /// The session file that named it.
    pub session: Option<Box<SessionFile>>,
}

impl From<Arc<NormalMap>> for OpenedMap {
    fn from(map: Arc<NormalMap>) -> Self {
        Self { map, fit: None, session: None }
    }
}

impl From<NormalMap> for OpenedMap {
    fn from(map: NormalMap) -> Self {
        Arc::new(map).into()
    }
}

impl From<FittedLobes> for OpenedMap {
    fn from(fit: FittedLobes) -> Self {
        Self { fit: Some(fit.clone()), ..Arc::clone(&fit.lobes.map).into() }
    }
}

/// A map, and what is made of it before it is shown.
pub struct Prepared {
    /// The map.
    pub opened: OpenedMap,
    /// Its mean normals.
    pub mip: Arc<PlainMip>,
    /// What its samples say of how they should be read.
    pub diagnosis: Diagnosis,
}

enum News {
    Opened(Prepared),
    Failed(Message),
    Dismissed,
}

/// The job that reads a map, if one runs.
#[derive(Default)]
pub struct Opening {
    job: Option<Job<News>>,
}

impl Opening {
    /// True while a map is being read or asked for.
    pub fn is_running(&self) -> bool {
        self.job.is_some()
    }

    /// Starts reading; an earlier request is dropped. `Err` is a sentence for the user.
    pub fn start(&mut self, request: MapRequest, wake: &Wake) -> Result<(), String> {
        self.spawn("open-map", wake, move |outbox| outbox.send(read_news(request)))
    }

    /// Asks for a file, then reads it. `Err` is a sentence for the user.
    pub fn start_dialog(&mut self, options: MapOptions, wake: &Wake) -> Result<(), String> {
        self.spawn("open-dialog", wake, move |outbox| {
            let dialog = rfd::FileDialog::new().set_title("Open a normal map or a session");
            let dialog = dialog.add_filter("Images and sessions", &EXTENSIONS);
            outbox.send(match dialog.pick_file() {
                Some(path) => read_news(MapRequest::File { path, options }),
                None => News::Dismissed,
            });
        })
    }

    fn spawn(
        &mut self,
        name: &str,
        wake: &Wake,
        work: impl FnOnce(&Outbox<News>) + Send + 'static,
    ) -> Result<(), String> {
        let job = Job::spawn(name, Arc::clone(wake), work);
        self.job =
            Some(job.map_err(|error| format!("The map cannot be opened: no thread could be started ({error})."))?);
        Ok(())
    }

    /// Takes a map that was read, or what the user should know.
    pub fn poll(&mut self) -> (Option<Prepared>, Option<Message>) {
        let Some(event) = self.job.as_ref().and_then(Job::next) else { return (None, None) };
        self.job = None;
        match event {
            JobEvent::News(News::Opened(prepared)) => (Some(prepared), None),
            JobEvent::News(News::Failed(message)) => (None, Some(message)),
            JobEvent::News(News::Dismissed) => (None, None),
            JobEvent::Panicked(text) => (None, Some(Message::error(format!("The map could not be opened: {text}.")))),
        }
    }
}

/// Extensions that the dialog offers.
const EXTENSIONS: [&str; 13] =
    ["png", "tga", "bmp", "tif", "tiff", "jpg", "jpeg", "webp", "hdr", "exr", "json", "PNG", "TGA"];

fn read_news(request: MapRequest) -> News {
    match read(&request) {
        Ok(opened) => {
            let mip = Arc::new(PlainMip::new(Arc::clone(&opened.map)));
            let diagnosis = opened.map.diagnose();
            News::Opened(Prepared { opened, mip, diagnosis })
        }
        Err(failure) => News::Failed(failure),
    }
}

/// Why a map was not opened.
struct Refused {
    sentence: String,
    is_greyscale: bool,
}

impl From<OpenError> for Refused {
    fn from(error: OpenError) -> Self {
        let is_greyscale = matches!(error, OpenError::Decode(DecodeError::Greyscale { .. }));
        Self { sentence: error.to_string(), is_greyscale }
    }
}

impl From<String> for Refused {
    fn from(sentence: String) -> Self {
        Self { sentence, is_greyscale: false }
    }
}

/// Reads a map now, and its colour.
///
/// # Errors
/// A sentence that names the file and the cause; a greyscale image comes with the offer to read it as heights.
pub fn read(request: &MapRequest) -> Result<OpenedMap, Message> {
    read_or_refuse(request).map_err(|refused| {
        let offer = || Box::new(Offer { label: "Open as heights", request: request.as_heights() });
        Message { offer: refused.is_greyscale.then(offer), ..Message::error(refused.sentence) }
    })
}

fn read_or_refuse(request: &MapRequest) -> Result<OpenedMap, Refused> {
    let (opened, options) = match request {
        MapRequest::File { path, options } if path.as_os_str() == "-" => {
            let bytes = image_io::read_bytes(path).map_err(|error| error.to_string())?;
            (read_bytes("standard input", &bytes, options)?, options)
        }
        MapRequest::File { path, .. } if SessionFile::is_named_by(path) => {
            return read_session(SessionFile::read(path).map_err(|error| error.to_string())?);
        }
        MapRequest::Bytes { name, bytes, .. } if SessionFile::is_named_by(Path::new(name)) => {
            return read_session(SessionFile::parse(name, bytes).map_err(|error| error.to_string())?);
        }
        MapRequest::Session(file) => return read_session((**file).clone()),
        MapRequest::File { path, options } if import::is_mesh_path(path) => return read_textures(path, options),
        MapRequest::File { path, options } => (read_file(path, options)?, options),
        MapRequest::Bytes { name, bytes, options } => (read_bytes(name, bytes, options)?, options),
        MapRequest::Bundled { name, options } => {
            let sample = procedural::find(name)
                .ok_or_else(|| format!("There is no bundled map named '{name}'; `sample --list` names them."))?;
            let mut map = sample.make(procedural::DEFAULT_SIZE);
            map.options.addressing = options.addressing;
            (map.into(), options)
        }
    };
    if options.color.is_some() { Ok(with_color(opened, options)?) } else { Ok(opened) }
}

impl MapRequest {
    /// The same, read as heights.
    fn as_heights(&self) -> Self {
        let mut request = self.clone();
        let options = match &mut request {
            Self::File { options, .. } | Self::Bytes { options, .. } | Self::Bundled { options, .. } => options,
            Self::Session(file) => &mut file.map_options,
        };
        options.height_scale = Some(MapOptions::HEIGHT_SCALE);
        request
    }
}

/// Reads the map of a session, or makes the default one where it names none.
fn read_session(mut file: SessionFile) -> Result<OpenedMap, Refused> {
    file.read_mesh().map_err(|error| error.to_string())?;
    let opened = match file.map_request() {
        // A session names a map, never another session.
        Some(MapRequest::File { path, .. }) if SessionFile::is_named_by(&path) => {
            return Err(format!("'{}' is a session, not a map.", path.display()).into());
        }
        Some(request) => read_or_refuse(&request)?,
        None => procedural::default_map().into(),
    };
    Ok(OpenedMap { session: Some(Box::new(file)), ..opened })
}

/// Reads the colour that the options name; the lobes of a fit take it too.
fn with_color(opened: OpenedMap, options: &MapOptions) -> Result<OpenedMap, String> {
    let OpenedMap { map, mut fit, session } = opened;
    let mut map = Arc::unwrap_or_clone(map);
    map.read_color(options).map_err(|error| error.to_string())?;
    let map = Arc::new(map);
    if let Some(fit) = &mut fit {
        let lobes = Arc::make_mut(&mut fit.lobes);
        lobes.map = Arc::clone(&map);
        let monitor = Monitor::new(vec![0; lobes.levels()]);
        color::fit_levels(lobes, fit.settings.kappa, &monitor, &mut |_, _| {}).map_err(|error| error.to_string())?;
    }
    Ok(OpenedMap { map, fit, session })
}

/// Reads the textures that a mesh file brings: its normals as the map and, unless another is named, its colour.
fn read_textures(path: &Path, options: &MapOptions) -> Result<OpenedMap, Refused> {
    let texture = |role| import::texture(path, role).map_err(|error| error.to_string());
    let normals = texture(TextureRole::Normal)?;
    let scale = options.slope_scale.or((normals.scale != 1.0).then_some(normals.scale));
    let options = MapOptions { slope_scale: scale, ..options.clone() };
    let mut map = NormalMap::read_bytes(&path.display().to_string(), &normals.bytes, &options)?;
    let own_color = options.color.is_none().then(|| import::texture(path, TextureRole::BaseColor).ok()).flatten();
    match own_color {
        Some(color) => {
            let name = format!("{} (base colour)", path.display());
            let image = image_io::decode_bytes(&name, &color.bytes).map_err(|error| error.to_string())?;
            map.wear_color(&image);
        }
        None => map.read_color(&options).map_err(|error| error.to_string())?,
    }
    Ok(map.into())
}

fn read_file(path: &Path, options: &MapOptions) -> Result<OpenedMap, Refused> {
    match lobes_exr::read(path, options).map_err(|error| error.to_string())? {
        Some(fit) => Ok(fit.into()),
        None => Ok(NormalMap::read(path, options)?.into()),
    }
}

fn read_bytes(name: &str, bytes: &[u8], options: &MapOptions) -> Result<OpenedMap, Refused> {
    let source = MapSource::File(name.into());
    match lobes_exr::read_bytes(bytes, source, options).map_err(|error| error.to_string())? {
        Some(fit) => Ok(fit.into()),
        None => Ok(NormalMap::read_bytes(name, bytes, options)?.into()),
    }
}
