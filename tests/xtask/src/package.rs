//! `cargo xtask package`: the robot's program as a Debian package, with its unit, its device rules and an example configuration.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;

use crate::{machine, shell};

/// What is built for which Debian architecture, and the linker that a foreign one needs.
const ARCHITECTURES: [Architecture; 2] = [
    Architecture { debian: "amd64", target: "x86_64-unknown-linux-gnu", linker: "x86_64-linux-gnu-gcc" },
    Architecture { debian: "arm64", target: "aarch64-unknown-linux-gnu", linker: "aarch64-linux-gnu-gcc" },
];

/// What goes where: file of the repository, place in the package, mode.
const FILES: [(&str, &str, u32); 6] = [
    ("packaging/systemd/floorguard.service", "usr/lib/systemd/system/floorguard.service", 0o644),
    ("packaging/udev/70-floorguard.rules", "usr/lib/udev/rules.d/70-floorguard.rules", 0o644),
    ("robot.toml", "usr/share/doc/floorguard/examples/robot.toml", 0o644),
    ("examples/velocity_client.py", "usr/share/doc/floorguard/examples/velocity_client.py", 0o644),
    ("LICENSE-APACHE", "usr/share/doc/floorguard/LICENSE-APACHE", 0o644),
    ("LICENSE-MIT", "usr/share/doc/floorguard/LICENSE-MIT", 0o644),
];
/// Programs that dpkg calls.
const SCRIPTS: [&str; 3] = ["postinst", "prerm", "postrm"];

struct Architecture {
    debian: &'static str,
    target: &'static str,
    linker: &'static str,
}

/// What to pack.
#[derive(Args)]
pub struct Options {
    /// Debian's name of the processor: amd64 or arm64. Without it, this computer's.
    #[arg(long)]
    architecture: Option<String>,
    /// With simulator, campaigns and training; without them it is the program of a robot.
    #[arg(long)]
    with_laboratory: bool,
    /// Folder of the package.
    #[arg(long, default_value = "target/package")]
    out: PathBuf,
}

/// Builds, packs, and lets dpkg read what it packed.
///
/// # Errors
/// The program does not build, or a tool is missing, which is named.
pub fn run(options: &Options) -> Result<bool> {
    ensure!(shell::is_installed("dpkg-deb"), "dpkg-deb is missing; please run as root: apt-get install dpkg");
    let architecture = architecture(options.architecture.as_deref())?;
    let program = build(architecture, options.with_laboratory)?;
    let file = pack(&program, architecture.debian, &shell::root().join(&options.out))?;
    println!("package: {} ({} KB)", file.display(), fs::metadata(&file)?.len() / 1024);
    println!("package: install it by: apt install {}", file.display());
    Ok(true)
}

/// The program with simulator for a processor by Debian's name.
///
/// # Errors
/// There is none for it, it does not build, or a tool is missing, which is named.
pub fn program_for(debian: &str) -> Result<PathBuf> {
    build(architecture(Some(debian))?, true)
}

fn architecture(named: Option<&str>) -> Result<&'static Architecture> {
    let here = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let is_it = |one: &&Architecture| named.map_or(one.target == here, |named| one.debian == named);
    ARCHITECTURES.iter().find(is_it).with_context(|| {
        format!("no package for {}; there are amd64 and arm64", named.unwrap_or(std::env::consts::ARCH))
    })
}

/// The program for a processor.
fn build(architecture: &Architecture, with_laboratory: bool) -> Result<PathBuf> {
    let target = architecture.target;
    if !machine::has_target(target) && !machine::add_target(target)? {
        bail!("the compiler target {target} is missing; please run: rustup target add {target}");
    }
    let is_foreign = !target.starts_with(std::env::consts::ARCH);
    if is_foreign && !shell::is_installed(architecture.linker) {
        bail!(
            "{} is missing; please run as root: apt-get install gcc-{}",
            architecture.linker,
            architecture.linker.trim_end_matches("-gcc")
        );
    }
    let mut cargo = shell::cargo();
    cargo.args(["build", "--release", "--locked", "--package", "floorguard", "--target", target]);
    cargo.args(["--features", "foxglove,fleet-tls"]);
    if !with_laboratory {
        cargo.arg("--no-default-features");
    }
    if is_foreign {
        let name = target.to_uppercase().replace('-', "_");
        cargo.env(format!("CARGO_TARGET_{name}_LINKER"), architecture.linker);
    }
    ensure!(shell::succeeds(&mut cargo)?, "the program does not build for {target}");
    Ok(shell::target_folder().join(target).join("release/floorguard"))
}

/// Puts the files in their places below a fresh folder and lets dpkg-deb pack them.
fn pack(program: &Path, architecture: &str, out: &Path) -> Result<PathBuf> {
    let name = format!("floorguard_{}_{architecture}", env!("CARGO_PKG_VERSION"));
    let stage = out.join(&name);
    if stage.exists() {
        fs::remove_dir_all(&stage)?;
    }
    place(program, &stage.join("usr/bin/floorguard"), 0o755)?;
    for (from, to, mode) in FILES {
        place(&shell::root().join(from), &stage.join(to), mode)?;
    }
    for script in SCRIPTS {
        place(
            &shell::root().join("packaging/debian").join(script),
            &stage.join("DEBIAN").join(script),
            0o755,
        )?;
    }
    fs::write(stage.join("DEBIAN/control"), control(architecture, size_kb(&stage)?))?;
    let file = out.join(format!("{name}.deb"));
    let mut dpkg = Command::new("dpkg-deb");
    dpkg.args(["--root-owner-group", "--build"]).arg(&stage).arg(&file).stdout(std::process::Stdio::null());
    ensure!(shell::succeeds(&mut dpkg)?, "dpkg-deb refuses {}", stage.display());
    fs::remove_dir_all(&stage)?;
    Ok(file)
}

fn place(from: &Path, to: &Path, mode: u32) -> Result<()> {
    fs::create_dir_all(to.parent().context("a file lies in a folder")?)?;
    fs::copy(from, to).with_context(|| format!("{} cannot be packed", from.display()))?;
    fs::set_permissions(to, fs::Permissions::from_mode(mode))?;
    Ok(())
}

/// What dpkg knows of the package (Debian policy manual, section 5.3).
fn control(architecture: &str, size_kb: u64) -> String {
    format!(
        "Package: floorguard\nVersion: {}\nArchitecture: {architecture}\nMaintainer: the floorguard developers \
         <floorguard@localhost>\nInstalled-Size: {size_kb}\nSection: misc\nPriority: optional\n\
         Depends: libc6 (>= 2.36), adduser\nRecommends: can-utils\nDescription: guard, perception and cleaning of a \
         floor-scrubbing robot\n Reads lidar, safety scanner, inertial sensor, encoders and drives, stops the motors in time,\n \
         tracks people, cleans a floor with a guarantee, and explains each stop.\n",
        env!("CARGO_PKG_VERSION")
    )
}

/// Sum of the files' sizes, each rounded up, as dpkg counts.
fn size_kb(folder: &Path) -> Result<u64> {
    let mut sum_kb = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let metadata = entry.metadata()?;
        sum_kb += match metadata.is_dir() {
            true => size_kb(&entry.path())?,
            false => metadata.len().div_ceil(1_024),
        };
    }
    Ok(sum_kb)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(arguments: &[&str], file: &Path) -> Option<String> {
        shell::output(Command::new("dpkg-deb").args(arguments).arg(file))
    }

    /// dpkg reads the package: everything is in its place, owned by root, and the scripts are programs.
    #[test]
    fn dpkg_reads_what_is_packed() {
        if !shell::is_installed("dpkg-deb") {
            eprintln!("skipped: dpkg-deb is not on this machine");
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("program");
        fs::write(&program, [0; 5_000]).unwrap();
        let file = pack(&program, "arm64", folder.path()).unwrap();
        let contents = listed(&["--contents"], &file).unwrap();
        for place in FILES.map(|(_, place, _)| place).into_iter().chain(["usr/bin/floorguard"]) {
            let line = contents.lines().find(|line| line.ends_with(&format!("./{place}")));
            let line = line.unwrap_or_else(|| panic!("{place} is missing:\n{contents}"));
            assert!(line.contains("root/root"), "{line}");
        }
        assert!(contents.contains("-rwxr-xr-x root/root      5000"), "{contents}");
        let fields = listed(&["--field"], &file).unwrap();
        assert!(fields.contains("Architecture: arm64") && fields.contains("Depends: libc6"), "{fields}");
        let scripts = listed(&["--ctrl-tarfile"], &file);
        assert!(scripts.is_none_or(|tar| !tar.is_empty()));
    }

    #[test]
    fn an_unknown_processor_is_refused_by_name() {
        let refused = architecture(Some("sparc")).err().unwrap().to_string();
        assert_eq!(refused, "no package for sparc; there are amd64 and arm64");
        assert_eq!(architecture(Some("arm64")).unwrap().target, "aarch64-unknown-linux-gnu");
    }

    /// The unit is one that systemd understands, and starts what the package installs.
    #[test]
    fn systemd_understands_the_unit() {
        let unit = shell::root().join("packaging/systemd/floorguard.service");
        let text = fs::read_to_string(&unit).unwrap();
        for needed in [
            "Type=notify",
            "WatchdogSec=2",
            "LimitRTPRIO=45",
            "ExecStart=/usr/bin/floorguard run",
            "DeviceAllow=",
        ] {
            assert!(text.contains(needed), "{needed}");
        }
        if !shell::is_installed("systemd-analyze") {
            eprintln!("skipped: systemd-analyze is not on this machine");
            return;
        }
        let mut verify = Command::new("systemd-analyze");
        let ended = verify.arg("verify").arg(&unit).output().unwrap();
        let output = String::from_utf8_lossy(&ended.stderr).into_owned();
        // The program is not installed where tests run; everything else would be a mistake in the file.
        let mistakes: Vec<&str> = output
            .lines()
            .filter(|line| line.contains("floorguard.service") && !line.contains("is not executable"))
            .filter(|line| !line.contains("man floorguard"))
            .collect();
        assert!(mistakes.is_empty(), "{mistakes:#?}");
    }
}
