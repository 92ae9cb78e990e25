//! Memory that is free, asked before much of it is taken: a refusal with its figures is better than a machine that
//! swaps, or a program that is ended.

use sysinfo::System;

/// Memory that can be taken now, bytes; `None` where the system does not say.
fn free() -> Option<u64> {
    let mut system = System::new().ok()?;
    system.refresh_memory();
    Some(system.available_memory()).filter(|&bytes| bytes > 0)
}

/// Makes sure that `need` bytes can be had.
///
/// # Errors
/// What is needed and what is free, in words.
pub fn check(need: u64) -> Result<(), String> {
    free().map_or(Ok(()), |free| compare(need, free))
}

fn compare(need: u64, free: u64) -> Result<(), String> {
    let gib = |bytes: u64| bytes as f64 / f64::from(1 << 30);
    if need <= free {
        return Ok(());
    }
    Err(format!("it needs {:.1} GiB of memory, and {:.1} GiB are free", gib(need), gib(free)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_is_free_is_refused_with_both_figures() {
        assert_eq!(compare(1 << 30, 1 << 30), Ok(()));
        let refused = compare(3 << 30, 3 << 29).expect_err("too much");
        assert_eq!(refused, "it needs 3.0 GiB of memory, and 1.5 GiB are free");
        assert!(check(1).is_ok() && check(u64::MAX).is_err());
    }
}
