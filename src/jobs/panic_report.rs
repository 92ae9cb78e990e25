//! A file for every panic: what happened, where, and the way there. Whoever reports a fault has something to send.

use std::backtrace::Backtrace;
use std::fs;
use std::panic::PanicHookInfo;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// The report of the last panic, until somebody is told.
static LAST: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Writes a report into `folder` for every panic from now on, in any thread; what the system prints stays.
pub fn install(folder: PathBuf) {
    let print = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        print(info);
        match write(&folder, &text(info)) {
            Ok(path) => {
                eprintln!("ndf-inspector: a report is in '{}'", path.display());
                *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(path);
            }
            Err(error) => eprintln!("ndf-inspector: no report could be written: {error}"),
        }
    }));
}

/// The report of the last panic, once.
pub fn take_last() -> Option<PathBuf> {
    LAST.lock().unwrap_or_else(PoisonError::into_inner).take()
}

fn text(info: &PanicHookInfo<'_>) -> String {
    let thread = std::thread::current();
    format!(
        "NDF Inspector {}, {} {}\nthread '{}': {info}\n\n{}\n",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH,
        thread.name().unwrap_or("unnamed"),
        Backtrace::force_capture(),
    )
}

/// Writes a report under a name of its own.
fn write(folder: &Path, text: &str) -> std::io::Result<PathBuf> {
    fs::create_dir_all(folder)?;
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let name = |count: u32| folder.join(format!("panic-{seconds}-{count}.txt"));
    let path = (0..).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(0));
    fs::write(&path, text)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_report_has_a_file_of_its_own() {
        let folder = tempfile::tempdir().expect("a folder");
        let inside = folder.path().join("reports");
        let paths = ["one", "two"].map(|text| write(&inside, text).expect("written"));
        assert_eq!(paths.map(|path| fs::read_to_string(path).expect("there")), ["one", "two"]);
    }
}
