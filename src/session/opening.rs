//! Maps read in the background, and the system's file dialog off the window's thread.

use std::path::PathBuf;
use std::sync::Arc;

use super::{Message, Offer};
use crate::filter::PlainMip;
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::normal_map::{DecodeError, MapOptions, NormalMap, OpenError, procedural};

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

/// A map and its mean normals.
pub type OpenedMap = (Arc<NormalMap>, Arc<PlainMip>);

enum News {
    Opened(OpenedMap),
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

    /// Takes a map that was read, or what the user should know.
    pub fn poll(&mut self) -> (Option<OpenedMap>, Option<Message>) {
        let Some(event) = self.job.as_ref().and_then(Job::next) else { return (None, None) };
        self.job = None;
        match event {
            JobEvent::News(News::Opened(map)) => (Some(map), None),
            JobEvent::News(News::Failed(message)) => (None, Some(message)),
            JobEvent::News(News::Dismissed) => (None, None),
            JobEvent::Panicked(text) => (None, Some(Message::error(format!("The map could not be opened: {text}.")))),
        }
    }
}

/// Extensions that the dialog offers.
const EXTENSIONS: [&str; 12] = ["png", "tga", "bmp", "tif", "tiff", "jpg", "jpeg", "webp", "hdr", "exr", "PNG", "TGA"];

fn read_news(request: MapRequest) -> News {
    match read(&request) {
        Ok(map) => {
            let map = Arc::new(map);
            let mip = Arc::new(PlainMip::new(Arc::clone(&map)));
            News::Opened((map, mip))
        }
        Err(failure) => News::Failed(failure),
    }
}

/// The height of the full range of a height map, in texel widths, unless told.
pub const DEFAULT_HEIGHT_SCALE: f32 = 4.0;

/// Reads a map now.
///
/// # Errors
/// A sentence that names the file and the cause; a greyscale image comes with the offer to read it as heights.
pub fn read(request: &MapRequest) -> Result<NormalMap, Message> {
    let read = match request {
        MapRequest::File { path, options } => NormalMap::read(path, options),
        MapRequest::Bytes { name, bytes, options } => NormalMap::read_bytes(name, bytes, options),
        MapRequest::Bundled { name, options } => {
            let sample = procedural::find(name).ok_or_else(|| {
                Message::error(format!("There is no bundled map named '{name}'; `sample --list` names them."))
            })?;
            let mut map = sample.make(procedural::DEFAULT_SIZE);
            map.options.addressing = options.addressing;
            Ok(map)
        }
    };
    read.map_err(|error| {
        let is_greyscale = matches!(error, OpenError::Decode(DecodeError::Greyscale { .. }));
        let offer = is_greyscale.then(|| Offer { label: "Open as heights", request: request.as_heights() });
        Message { offer, ..Message::error(error.to_string()) }
    })
}

impl MapRequest {
    /// The same, read as heights.
    fn as_heights(&self) -> Self {
        let mut request = self.clone();
        let (Self::File { options, .. } | Self::Bytes { options, .. } | Self::Bundled { options, .. }) = &mut request;
        options.height_scale = Some(DEFAULT_HEIGHT_SCALE);
        request
    }
}
