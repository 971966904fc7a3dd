//! Output for people (standard error) and for machines (standard output). Never a panic: a robot outlives its readers.
//!
//! The macros of the standard library panic when a terminal is gone, a pipe is closed or the disk of a log is full.

use std::fmt::Display;

/// Says a line to people. Nobody listens any more: then it is not heard.
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!($crate::anstream::stderr(), $($words)*);
    }};
}

/// Tells a machine a line; an error if it cannot be written.
#[macro_export]
macro_rules! tell {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        writeln!($crate::anstream::stdout(), $($words)*)
    }};
}

/// Lines for a machine that may stop to listen, while what they tell of goes on.
#[derive(Debug, Default)]
pub struct Lines {
    ended: bool,
}

impl Lines {
    /// Tells a line, and says once when that is not possible any more.
    pub fn tell(&mut self, line: &impl Display) {
        if self.ended {
            return;
        }
        if let Err(error) = tell!("{line}") {
            self.ended = true;
            say!("  standard output takes nothing any more ({error}); the robot goes on without it");
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    /// The macros of the standard library and of its likes panic where nobody listens.
    #[test]
    fn nothing_else_speaks() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let packages = [
            "runtime/host",
            "runtime/robot",
            "runtime/recording",
            "runtime/operator",
            "runtime/app",
            "hal-sim/laboratory",
        ];
        let (mut folders, mut seen) = (packages.map(|package| root.join(package).join("src")).to_vec(), 0);
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                if ["_tests.rs", "/tests.rs"].iter().any(|end| path.to_string_lossy().ends_with(end)) {
                    continue;
                }
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let forbidden = code.lines().find(|line| {
                    ["println!(", "print!("].iter().any(|word| line.contains(word))
                        && !line.contains("bar.println")
                });
                assert_eq!(forbidden, None, "{}: use say! or tell!", path.display());
                seen += 1;
            }
        }
        assert!(seen > 100);
    }
}
