//! The frame log: what each frame cost the thread of the window.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use super::WindowError;

/// A file with a line for each frame, of three numbers in milliseconds: since the window opened, when the frame began;
/// what the panels took; and what the thread of the window took in all, tessellation, uploads and the recording of
/// passes with them, waits for the adapter left out. The gaps between lines are the pace.
pub struct FrameLog {
    file: BufWriter<File>,
    opened: Instant,
    began: Instant,
    panels: Option<Duration>,
}

impl FrameLog {
    pub fn create(path: &Path) -> Result<Self, WindowError> {
        let file = File::create(path).map_err(|cause| WindowError::FrameLog(path.display().to_string(), cause))?;
        let now = Instant::now();
        Ok(Self { file: BufWriter::new(file), opened: now, began: now, panels: None })
    }

    /// A frame begins; `thread_seconds` is what the toolkit says the one before took.
    pub fn begin(&mut self, thread_seconds: Option<f32>) {
        self.write(thread_seconds);
        self.began = Instant::now();
    }

    /// The panels of the frame are done.
    pub fn end_panels(&mut self) {
        self.panels = Some(self.began.elapsed());
    }

    /// Writes the line of the frame before, where there was one.
    fn write(&mut self, thread_seconds: Option<f32>) {
        let Some(panels) = self.panels.take() else { return };
        let milliseconds = |duration: Duration| duration.as_secs_f64() * 1000.0;
        let (at, panels) = (milliseconds(self.began - self.opened), milliseconds(panels));
        let thread = thread_seconds.map_or(panels, |seconds| 1000.0 * f64::from(seconds));
        let written = writeln!(self.file, "{at:.3} {panels:.3} {thread:.3}").and_then(|()| self.file.flush());
        if let Err(error) = written {
            log::warn!("a line of the frame log was lost: {error}");
        }
    }
}
