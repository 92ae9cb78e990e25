//! The frame log: what each frame cost the thread of the window.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use super::WindowError;

/// A file with a line for each frame, of three numbers in milliseconds: since the window opened, when the frame began;
/// what the panels took by the clock; and the processor's time that the window's thread spent in all until the next
/// frame, with tessellation, uploads and the recording of passes, but without waits for the adapter or for other
/// programs. The gaps between lines are the pace.
pub struct FrameLog {
    file: BufWriter<File>,
    opened: Instant,
    began: Instant,
    panels: Option<Duration>,
    spent: Option<Duration>,
}

impl FrameLog {
    pub fn create(path: &Path) -> Result<Self, WindowError> {
        let file = File::create(path).map_err(|cause| WindowError::FrameLog(path.display().to_string(), cause))?;
        let now = Instant::now();
        Ok(Self { file: BufWriter::new(file), opened: now, began: now, panels: None, spent: thread_time() })
    }

    /// A frame begins; `thread_seconds` is what the toolkit says the one before took, for systems that do not tell.
    pub fn begin(&mut self, thread_seconds: Option<f32>) {
        let spent = thread_time();
        let by_system = spent.zip(self.spent).map(|(now, before)| now.saturating_sub(before).as_secs_f64());
        self.write(by_system.or(thread_seconds.map(f64::from)));
        (self.began, self.spent) = (Instant::now(), spent);
    }

    /// The panels of the frame are done.
    pub fn end_panels(&mut self) {
        self.panels = Some(self.began.elapsed());
    }

    /// Writes the line of the frame before, where there was one.
    fn write(&mut self, thread_seconds: Option<f64>) {
        let Some(panels) = self.panels.take() else { return };
        let milliseconds = |duration: Duration| duration.as_secs_f64() * 1000.0;
        let (at, panels) = (milliseconds(self.began - self.opened), milliseconds(panels));
        let thread = thread_seconds.map_or(panels, |seconds| 1000.0 * seconds);
        let written = writeln!(self.file, "{at:.3} {panels:.3} {thread:.3}").and_then(|()| self.file.flush());
        if let Err(error) = written {
            log::warn!("a line of the frame log was lost: {error}");
        }
    }
}

/// The processor's time that this thread has spent, where the system tells.
fn thread_time() -> Option<Duration> {
    #[cfg(any(target_os = "linux", target_os = "macos"))]
    {
        let spent = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Duration::try_from(spent).ok()
    }
    #[cfg(not(any(target_os = "linux", target_os = "macos")))]
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_when_a_frame_began_and_what_it_cost() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frames.txt");
        let mut log = FrameLog::create(&path).expect("a file");
        log.begin(None);
        log.end_panels();
        log.begin(Some(0.004));
        let text = std::fs::read_to_string(&path).expect("written");
        let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().expect("a number")).collect();
        assert!(
            text.lines().count() == 1 && numbers.len() == 3 && numbers.iter().all(|&number| number >= 0.0),
            "{text}"
        );
    }
}
