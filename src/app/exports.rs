//! Exports from the window: what is written, the job that writes it, and a look at it beforehand.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Color32, ColorImage, TextureHandle, TextureOptions};

use super::export_view::{ExportKind, ExportView};
use super::surface_picture::{captioned, surface_picture};
use crate::export::lobe_shader::lobe_shader;
use crate::export::lobes_exr::FittedLobes;
use crate::export::roughness::RoughnessSettings;
use crate::export::{lobes_exr, slopes};
use crate::filter::PlainMip;
use crate::gpu::Gpu;
use crate::image_io::{write_bytes_atomically, write_png_rgba8};
use crate::jobs::{Job, JobEvent, Outbox, Wake};
use crate::session::{Message, Session};

/// Where an export goes.
#[derive(Clone, Debug, PartialEq)]
pub enum ExportTarget {
    /// This path.
    Path(PathBuf),
    /// The path that the system's dialog is asked for.
    Dialog,
}

/// What is to be written, apart from the session, so that a job may write it.
enum Content {
    Roughness(RoughnessSettings, Arc<PlainMip>),
    Slopes(Arc<PlainMip>),
    Lobes(FittedLobes),
    Text(String),
    Picture { session: Box<Session>, gpu: Gpu, caption: bool },
}

/// The files that were written, a sentence why they were not, or nothing where the dialog was dismissed.
type Written = Option<Result<Vec<PathBuf>, String>>;

/// The export under way, if any, and the picture of roughness.
pub struct Exports {
    gpu: Gpu,
    wake: Wake,
    writing: Option<Job<Written>>,
    preview: Option<(PreviewKey, TextureHandle)>,
}

type PreviewKey = (u64, usize, RoughnessSettings);

/// Pixels across and down of an exported picture.
const PICTURE_SIZE: [u32; 2] = [1600, 1000];

/// Most pixels along a side of the picture of roughness.
const PREVIEW_SIDE: usize = 128;

impl Exports {
    /// Nothing under way. Draws on `gpu`, and calls `wake` when there are news.
    pub fn new(gpu: Gpu, wake: Wake) -> Self {
        Self { gpu, wake, writing: None, preview: None }
    }

    /// True while a file is being asked for or written.
    pub fn is_writing(&self) -> bool {
        self.writing.is_some()
    }

    /// Starts to write what the view says. `Err` is a sentence for the user.
    pub fn start(&mut self, session: &Session, view: &ExportView, target: ExportTarget) -> Result<(), Message> {
        let mut content = self.content(session, view).map_err(Message::error)?;
        let (kind, ending) = (view.kind, view.ending());
        let suggested = view.suggested_path(&session.map().source);
        let work = move |outbox: &Outbox<Written>| {
            let path = match target {
                ExportTarget::Path(path) => Some(path),
                ExportTarget::Dialog => ask(kind, ending, &suggested),
            };
            outbox.send(path.map(|path| content.write(&path)));
        };
        let job = Job::spawn("export", Arc::clone(&self.wake), work);
        self.writing = Some(job.map_err(|error| Message::error(format!("Nothing can be exported: {error}.")))?);
        Ok(())
    }

    fn content(&self, session: &Session, view: &ExportView) -> Result<Content, String> {
        Ok(match view.kind {
            ExportKind::Roughness => Content::Roughness(view.roughness, Arc::clone(session.mip())),
            ExportKind::Slopes => Content::Slopes(Arc::clone(session.mip())),
            ExportKind::Lobes => Content::Lobes(session.fitting().finished().ok_or("The fit is not finished.")?),
            ExportKind::Shader => {
                let text = lobe_shader(session.fit_settings().lobes, view.language);
                Content::Text(text.map_err(|error| format!("The shader was not written: {error}."))?)
            }
            ExportKind::Picture => {
                let shows_lobes = session.comparison.methods_seen().iter().any(|method| method.shows_lobes());
                if shows_lobes && !session.fitting().is_complete() {
                    return Err("The fit is not finished.".to_owned());
                }
                let mut fork = session.fork(false, Arc::clone(&self.wake));
                fork.comparison = session.comparison;
                Content::Picture { session: Box::new(fork), gpu: self.gpu.clone(), caption: view.caption }
            }
        })
    }

    /// Takes the job's news; sentences for the user go to `messages`.
    pub fn poll(&mut self, messages: &mut Vec<Message>) {
        if let Some(event) = self.writing.as_ref().and_then(Job::next) {
            self.writing = None;
            messages.extend(match event {
                JobEvent::News(written) => written.map(told),
                JobEvent::Panicked(text) => Some(Message::error(format!("The export failed: {text}."))),
            });
        }
    }

    /// The roughness of a level as a picture, black where it is 0; made anew when it changes.
    pub fn preview(&mut self, ctx: &egui::Context, session: &Session, settings: RoughnessSettings) -> &TextureHandle {
        let level = session.selected().level;
        let key = (session.map_revision(), level, settings);
        let made = self.preview.take().filter(|(made, _)| *made == key);
        let make = || {
            let image = picture(session, level, settings);
            (key, ctx.load_texture("roughness", image, TextureOptions::NEAREST))
        };
        &self.preview.insert(made.unwrap_or_else(make)).1
    }
}

impl Content {
    fn write(&mut self, path: &Path) -> Result<Vec<PathBuf>, String> {
        let one = |()| vec![path.to_owned()];
        let written = match self {
            Self::Roughness(settings, mip) => settings.write(path, mip),
            Self::Slopes(mip) => slopes::write(path, mip).map(one),
            Self::Lobes(fit) => lobes_exr::write(path, fit).map(one),
            Self::Text(text) => write_bytes_atomically(path, text.as_bytes()).map(one),
            Self::Picture { session, gpu, caption } => return write_picture(path, session, gpu, *caption),
        };
        written.map_err(|error| format!("{error}."))
    }
}

/// Draws the surface anew, apart from the window.
fn write_picture(path: &Path, session: &mut Session, gpu: &Gpu, caption: bool) -> Result<Vec<PathBuf>, String> {
    let drawn = surface_picture(gpu, session, PICTURE_SIZE);
    let drawn = drawn.and_then(|picture| if caption { captioned(gpu, picture, session) } else { Ok(picture) });
    let picture = drawn.map_err(|error| format!("'{}' cannot be written: {error}.", path.display()))?;
    let [width, height] = picture.size.map(|side| side as usize);
    write_png_rgba8(path, width, height, &picture.rgba).map_err(|error| format!("{error}."))?;
    Ok(vec![path.to_owned()])
}

fn ask(kind: ExportKind, ending: &str, suggested: &Path) -> Option<PathBuf> {
    let name = suggested.file_name().unwrap_or_default().to_string_lossy();
    let mut dialog = rfd::FileDialog::new().set_title("Export").set_file_name(name);
    if let Some(folder) = suggested.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        dialog = dialog.set_directory(folder);
    }
    dialog.add_filter(kind.label(), &[ending]).save_file()
}

fn told(written: Result<Vec<PathBuf>, String>) -> Message {
    match written.as_deref() {
        Ok([only]) => Message::remark(format!("The export is in '{}'.", only.display())),
        Ok([first, ..]) => {
            let count = written.as_ref().map_or(0, Vec::len);
            Message::remark(format!("The export is in {count} files from '{}' on.", first.display()))
        }
        Ok([]) => Message::error("Nothing was exported, for the map has no levels."),
        Err(sentence) => Message::error(sentence.clone()),
    }
}

/// A level's roughness, shrunk by leaving texels out.
fn picture(session: &Session, level: usize, settings: RoughnessSettings) -> ColorImage {
    let (width, height) = session.map().level_size(level);
    let shrink = width.max(height).div_ceil(PREVIEW_SIDE);
    let [columns, rows] = [width, height].map(|side| (side / shrink).max(1));
    let pixel = |index: usize| {
        let texel = (index / columns * height / rows) * width + index % columns * width / columns;
        let length = f64::from(session.mip().levels[level][texel].length());
        Color32::from_gray((255.0 * settings.of_length(length)).round() as u8)
    };
    ColorImage::new([columns, rows], (0..columns * rows).map(pixel).collect())
}
