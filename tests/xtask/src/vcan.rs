//! `cargo xtask vcan`: the SocketCAN carrier for real, on `vcan0` of a Linux that runs as a process (User-Mode Linux).
//!
//! Most machines of CI have no CAN in their kernel. The little Linux has: it loads the modules, makes `vcan0`, and runs the
//! robot and the simulated drives, encoders and inputs against each other over it, in real time.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};
use clap::Args;

use crate::{machine, program, shell};

/// The modules, in the order of loading.
const MODULES: [&str; 4] =
    ["net/can/can.ko", "drivers/net/can/dev/can-dev.ko", "net/can/can-raw.ko", "drivers/net/can/vcan.ko"];
/// Nothing drives without drives, encoders and inputs that answer.
const DRIVEN_MIN_M: f64 = 0.5;
/// What the little Linux prints before the exit code of the program.
const EXIT_MARK: &str = "vcan-exit-code:";

/// What to play.
#[derive(Args)]
pub struct Options {
    /// The scenario.
    #[arg(long, default_value = "crossing")]
    scenario: String,
    /// Seed of all randomness.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Seconds, in real time.
    #[arg(long, default_value_t = 10)]
    duration: u32,
}

/// Builds the program, packs it with the modules, boots, and judges by the program's own verdict.
pub fn run(options: &Options) -> Result<bool> {
    if !machine::has_user_mode_linux() && !machine::add_user_mode_linux()? {
        eprintln!(
            "vcan: cannot install it here; please run as root: apt-get install {}",
            machine::VCAN_PACKAGES.join(" ")
        );
        return Ok(false);
    }
    let program = program::built("floorguard")?;
    let folder = shell::target_folder().join("vcan");
    let image = pack(&folder, &program, options)?;
    println!("vcan: booting a Linux with vcan0");
    let printed = boot(&image)?;
    judge(&printed)
}

/// Boots and gives everything that it prints.
fn boot(image: &Path) -> Result<String> {
    let mut linux = Command::new("linux.uml");
    linux.args(["mem=512M", "con=null", "con0=null,fd:1", "ssl=null", "quiet", "panic=-1"]);
    linux.arg(format!("initrd={}", image.display())).stdin(Stdio::null());
    let output = linux.output().context("cannot start linux.uml")?;
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn judge(printed: &str) -> Result<bool> {
    let code = printed.lines().find_map(|line| line.trim().strip_prefix(EXIT_MARK));
    let Some(code) = code else {
        bail!("vcan: the little Linux ended without running the program; it printed:\n{printed}");
    };
    for line in printed.lines().filter(|line| !line.contains(EXIT_MARK)) {
        println!("  {line}");
    }
    let driven_m = driven_m(printed).unwrap_or(0.0);
    let good = code.trim() == "0" && driven_m > DRIVEN_MIN_M;
    let word = if good { "good" } else { "FAILED (a busy machine can be too slow for real time: try again)" };
    println!("vcan: {driven_m:.1} m driven with drives, encoders and inputs on SocketCAN: {word}");
    Ok(good)
}

/// From the verdict of the program.
fn driven_m(printed: &str) -> Option<f64> {
    let verdict = printed.lines().find(|line| line.trim_start().starts_with('{'))?;
    serde_json::from_str::<serde_json::Value>(verdict).ok()?["distance_m"].as_f64()
}

/// The first file system: busybox, modules, the program and its libraries, and what to do.
fn pack(folder: &Path, program: &Path, options: &Options) -> Result<PathBuf> {
    let root = folder.join("root");
    if root.exists() {
        std::fs::remove_dir_all(&root).context("cannot clear the old file system")?;
    }
    for name in ["bin", "proc", "sys", "dev", "modules", "tmp"] {
        std::fs::create_dir_all(root.join(name))?;
    }
    copy(Path::new("/bin/busybox"), &root.join("bin/busybox"))?;
    copy(program, &root.join("bin/floorguard"))?;
    for library in libraries(program)? {
        let inside = root.join(library.strip_prefix("/").unwrap_or(&library));
        std::fs::create_dir_all(inside.parent().unwrap_or(&root))?;
        copy(&library, &inside)?;
    }
    let kernel = machine::user_mode_modules().context("no modules of User-Mode Linux")?;
    for module in MODULES {
        let from = kernel.join("kernel").join(module);
        let name = from.file_name().unwrap_or_default().to_owned();
        copy(&from, &root.join("modules").join(name))?;
    }
    let script = root.join("init");
    std::fs::write(&script, init_script(options))?;
    make_executable(&script)?;
    let image = folder.join("initrd.gz");
    let mut archive = Command::new("sh");
    archive.current_dir(&root);
    archive.args(["-c", "find . | cpio --quiet -o -H newc | gzip -1 > ../initrd.gz"]);
    if !shell::succeeds(&mut archive)? {
        bail!("vcan: cannot pack the file system");
    }
    Ok(image)
}

fn init_script(options: &Options) -> String {
    let mut text = String::from(
        "#!/bin/busybox sh\n/bin/busybox mount -t proc none /proc\n/bin/busybox mount -t sysfs none /sys\n\
         /bin/busybox mount -t devtmpfs none /dev\n/bin/busybox mkdir -p /dev/pts\n\
         /bin/busybox mount -t devpts -o ptmxmode=0666 none /dev/pts\n/bin/busybox ip link set up lo\n",
    );
    for module in MODULES {
        let name = Path::new(module).file_name().unwrap_or_default().to_string_lossy().into_owned();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "/bin/busybox insmod /modules/{name}");
    }
    text.push_str("/bin/busybox ip link add dev vcan0 type vcan\n/bin/busybox ip link set up vcan0\n");
    let Options { scenario, seed, duration } = options;
    let _ = writeln!(
        text,
        "/bin/floorguard simulate --scenario {scenario} --seed {seed} --duration {duration} --real-io --can-interface vcan0 --json 2>&1\n\
         echo {EXIT_MARK}$?\n/bin/busybox cat /proc/net/can/stats | /bin/busybox head -4\n/bin/busybox poweroff -f"
    );
    text
}

/// The shared libraries of the program, and the loader.
fn libraries(program: &Path) -> Result<Vec<PathBuf>> {
    let listed =
        shell::output(Command::new("ldd").arg(program)).context("ldd does not understand the program")?;
    let paths = listed.lines().filter_map(|line| line.split_whitespace().find(|word| word.starts_with('/')));
    Ok(paths.map(PathBuf::from).collect())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    std::fs::copy(from, to).with_context(|| format!("{} cannot be copied", from.display()))?;
    Ok(())
}

fn make_executable(path: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o755))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdict_is_the_programs_exit_code() {
        let driven = "{\"distance_m\":3.5}\nvcan-exit-code:";
        assert!(judge(&format!("{driven}0\n")).unwrap() && !judge(&format!("{driven}1\n")).unwrap());
        assert!(!judge("{\"distance_m\":0.0}\nvcan-exit-code:0\n").unwrap());
        assert!(judge("Kernel panic").is_err());
    }
}
