//! Maps read in the background, and the system's file dialog off the window's thread.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::export::lobes_exr::{self, FittedLobes};
use crate::filter::PlainMip;
use crate::filter::vmf::{Monitor, color};
use crate::image_io;
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::normal_map::{MapOptions, MapSource, NormalMap, procedural};

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
}

/// A map that was read, and its lobes where the file holds a fit.
#[derive(Clone, Debug)]
pub struct OpenedMap {
    /// The map.
    pub map: Arc<NormalMap>,
    /// The fit of it that came along.
    pub fit: Option<FittedLobes>,
}

impl From<NormalMap> for OpenedMap {
    fn from(map: NormalMap) -> Self {
        Self { map: Arc::new(map), fit: None }
    }
}

impl From<FittedLobes> for OpenedMap {
    fn from(fit: FittedLobes) -> Self {
        Self { map: Arc::clone(&fit.lobes.map), fit: Some(fit) }
    }
}

/// A map and its mean normals.
pub type OpenedWithMip = (OpenedMap, Arc<PlainMip>);

enum News {
    Opened(OpenedWithMip),
    Failed(String),
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
            let dialog = rfd::FileDialog::new().set_title("Open a normal map").add_filter("Images", &EXTENSIONS);
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

    /// Takes a map that was read, and the sentences for the user.
    pub fn poll(&mut self) -> (Option<OpenedWithMip>, Vec<String>) {
        match self.job.as_ref().and_then(Job::next) {
            None => (None, Vec::new()),
            Some(event) => {
                self.job = None;
                match event {
                    JobEvent::News(News::Opened(map)) => (Some(map), Vec::new()),
                    JobEvent::News(News::Failed(sentence)) => (None, vec![sentence]),
                    JobEvent::News(News::Dismissed) => (None, Vec::new()),
                    JobEvent::Panicked(text) => (None, vec![format!("The map could not be opened: {text}.")]),
                }
            }
        }
    }
}

/// Extensions that the dialog offers.
const EXTENSIONS: [&str; 12] = ["png", "tga", "bmp", "tif", "tiff", "jpg", "jpeg", "webp", "hdr", "exr", "PNG", "TGA"];

fn read_news(request: MapRequest) -> News {
    match read(&request) {
        Ok(opened) => {
            let mip = Arc::new(PlainMip::new(Arc::clone(&opened.map)));
            News::Opened((opened, mip))
        }
        Err(sentence) => News::Failed(sentence),
    }
}

/// Reads a map now, and its colour. `Err` is a sentence that names the file and the cause.
pub fn read(request: &MapRequest) -> Result<OpenedMap, String> {
    let (opened, options) = match request {
        MapRequest::File { path, options } if path.as_os_str() == "-" => {
            let bytes = image_io::read_bytes(path).map_err(|error| error.to_string())?;
            (read_bytes("standard input", &bytes, options)?, options)
        }
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
    if options.color.is_some() { with_color(opened, options) } else { Ok(opened) }
}

/// Reads the colour that the options name; the lobes of a fit take it too.
fn with_color(opened: OpenedMap, options: &MapOptions) -> Result<OpenedMap, String> {
    let OpenedMap { map, mut fit } = opened;
    let mut map = Arc::unwrap_or_clone(map);
    map.read_color(options).map_err(|error| error.to_string())?;
    let map = Arc::new(map);
    if let Some(fit) = &mut fit {
        let lobes = Arc::make_mut(&mut fit.lobes);
        lobes.map = Arc::clone(&map);
        let monitor = Monitor::new(vec![0; lobes.levels()]);
        color::fit_levels(lobes, fit.settings.kappa, &monitor, &mut |_, _| {}).map_err(|error| error.to_string())?;
    }
    Ok(OpenedMap { map, fit })
}

fn read_file(path: &Path, options: &MapOptions) -> Result<OpenedMap, String> {
    match lobes_exr::read(path, options).map_err(|error| error.to_string())? {
        Some(fit) => Ok(fit.into()),
        None => NormalMap::read(path, options).map(OpenedMap::from).map_err(|error| error.to_string()),
    }
}

fn read_bytes(name: &str, bytes: &[u8], options: &MapOptions) -> Result<OpenedMap, String> {
    let source = MapSource::File(name.into());
    match lobes_exr::read_bytes(bytes, source, options).map_err(|error| error.to_string())? {
        Some(fit) => Ok(fit.into()),
        None => NormalMap::read_bytes(name, bytes, options).map(OpenedMap::from).map_err(|error| error.to_string()),
    }
}
