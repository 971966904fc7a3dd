//! A computer made of files: each finding, good and bad.

use std::os::unix::fs::symlink;
use std::path::Path;

use floorguard_configuration::{CanAddress, Carriers, EXAMPLE, ScannerAddress, parse};

use super::command::verdict;
use super::computer::Computer;
use super::finding::{Finding, State};
use super::{devices, system};

struct Files(tempfile::TempDir);

impl Files {
    fn new() -> Self {
        let files = Self(tempfile::tempdir().unwrap());
        for (path, text) in [
            ("proc/version", "Linux version 6.12.0-rt5 #1 SMP PREEMPT_RT"),
            ("proc/sys/kernel/osrelease", "6.12.0-rt5\n"),
            ("sys/kernel/realtime", "1\n"),
            ("proc/sys/net/core/rmem_default", "425984\n"),
            ("proc/net/udp", UDP_HEADER),
            ("sys/devices/system/cpu/cpu0/online", "1"),
            ("sys/devices/system/cpu/cpu1/online", "1"),
            ("sys/devices/system/cpu/cpufreq/note", ""),
            ("run/systemd/timesync/synchronized", ""),
        ] {
            files.write(path, text);
        }
        files
    }

    fn write(&self, path: &str, text: &str) {
        let path = self.0.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// A process that has something open.
    fn process(&self, number: u32, name: &str, target: &str) {
        self.write(&format!("proc/{number}/comm"), &format!("{name}\n"));
        let folder = self.0.path().join(format!("proc/{number}/fd"));
        std::fs::create_dir_all(&folder).unwrap();
        symlink(target, folder.join("3")).unwrap();
    }

    fn computer(&self) -> Computer {
        Computer::at(self.0.path().to_path_buf(), Ok(()))
    }
}

const UDP_HEADER: &str = "  sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout inode ref pointer drops\n";
/// Port 2368 at all addresses, as Linux 6.1 prints it.
const UDP_LIDAR: &str = " 1234: 00000000:0940 00000000:0000 07 00000000:00000000 00:00000000 00000000     0        0 81234 2 0000000000000000 0\n";

fn example() -> Carriers {
    parse("robot.toml", EXAMPLE).unwrap().carriers
}

fn of<'a>(findings: &'a [Finding], what: &str) -> &'a Finding {
    findings
        .iter()
        .find(|finding| finding.what.starts_with(what))
        .unwrap_or_else(|| panic!("{what}: {findings:#?}"))
}

#[test]
fn a_prepared_computer_is_good() {
    let files = Files::new();
    let findings = system::findings(&files.computer(), Path::new("."));
    let not_good =
        |finding: &&Finding| finding.state != State::Good && !finding.what.starts_with("free disk");
    assert_eq!(findings.iter().find(not_good), None);
    assert_eq!(of(&findings, "processors").found, "2");
    assert_eq!(of(&findings, "UDP").found, "425984 bytes: 244 ms of lidar packets");
}

#[test]
fn each_shortage_is_named_with_its_remedy() {
    let files = Files::new();
    files.write("proc/version", "Linux version 6.1.0 #1 SMP PREEMPT_DYNAMIC");
    files.write("sys/kernel/realtime", "0\n");
    files.write("proc/sys/net/core/rmem_default", "106496\n");
    files.write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n");
    std::fs::remove_dir_all(files.0.path().join("sys/devices/system/cpu/cpu1")).unwrap();
    std::fs::remove_file(files.0.path().join("run/systemd/timesync/synchronized")).unwrap();
    let computer = Computer::at(files.0.path().to_path_buf(), Err("not permitted".to_owned()));
    let findings = system::findings(&computer, Path::new("."));
    for what in ["kernel", "processors", "processor frequency", "clock", "UDP receive buffer"] {
        let finding = of(&findings, what);
        assert_eq!(finding.state, State::Warning, "{finding}");
        assert!(!finding.remedy.is_empty(), "{finding}");
    }
    assert_eq!(of(&findings, "real-time priority").state, State::Bad);
    assert_eq!(verdict(&findings), "failed");
}

#[test]
fn absent_devices_and_interfaces_are_bad() {
    let findings = devices::findings(&Files::new().computer(), &example());
    for section in ["[scanner]", "[imu]", "[can]"] {
        assert_eq!(of(&findings, section).state, State::Bad, "{findings:#?}");
    }
    assert_eq!(of(&findings, "[lidar] udp").state, State::Good);
}

#[test]
fn holder_of_a_line_or_port_is_named() {
    let files = Files::new();
    let carriers = example();
    let ScannerAddress::Serial(line) = &carriers.scanner else { panic!("the example has an S300") };
    let device = line.device.to_str().unwrap();
    files.write(device.trim_start_matches('/'), "");
    files.write("proc/net/udp", &format!("{UDP_HEADER}{UDP_LIDAR}"));
    let free = devices::findings(&files.computer(), &carriers);
    assert_eq!(of(&free, "[scanner]").state, State::Good, "{free:#?}");
    assert_eq!(of(&free, "[lidar] udp").found, "taken by another user's program");
    files.process(4_711, "minicom", device);
    files.process(4_712, "rviz2", "socket:[81234]");
    let held = devices::findings(&files.computer(), &carriers);
    assert_eq!(of(&held, "[scanner]").found, "open in minicom (process 4711)");
    assert_eq!(of(&held, "[lidar] udp").found, "taken by rviz2 (process 4712)");
}

#[test]
fn can_interface_must_be_one_and_be_up() {
    let files = Files::new();
    let carriers = Carriers { can: Some(CanAddress::SocketCan("can0".to_owned())), ..example() };
    let look = || of(&devices::findings(&files.computer(), &carriers), "[can]").clone();
    assert_eq!(look().found, "no such network interface");
    files.write("sys/class/net/can0/type", "1\n");
    assert_eq!(look().found, "no CAN interface");
    files.write("sys/class/net/can0/type", "280\n");
    files.write("sys/class/net/can0/flags", "0x40080\n");
    assert_eq!(look().found, "down");
    assert!(look().remedy.contains("bitrate 500000"));
    files.write("sys/class/net/can0/flags", "0x40081\n");
    assert_eq!(look(), Finding::good("[can] can0", "up"));
}
