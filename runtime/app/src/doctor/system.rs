//! Kernel, processors, priorities, clock, network buffers, disk.

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use super::computer::Computer;
use super::finding::Finding;

/// Both rings compute at the same time.
const PROCESSORS_MIN: usize = 2;
/// What the kernel counts for one lidar packet of 1,206 bytes in a socket's buffer: the next larger block and its header
/// (measured on Linux 6.18 with `ss --memory`: 92 packets fit 212,992 bytes).
const BUFFERED_PACKET_BYTES: u64 = 2_304;
/// Packets of a VLP-16 with single returns, a second (VLP-16 manual, section 9.3: 754).
const PACKETS_HZ: u64 = 754;
/// A buffer holds what comes while the guard ring waits this long at most, milliseconds: a sweep.
const BUFFER_MIN_MS: u64 = 100;
/// A recording of an hour needs about 13.5 GB (672 MB in the demo's 180 s).
const DISK_MIN_BYTES: u64 = 15_000_000_000;
/// Before this the clock was never set, seconds since 1970: the first of January 2025.
const CLOCK_MIN_S: u64 = 1_735_689_600;

/// What holds for every robot.
pub(super) fn findings(computer: &Computer, folder: &Path) -> Vec<Finding> {
    vec![
        kernel(computer),
        real_time(computer),
        processors(computer),
        governor(computer),
        clock(computer),
        receive_buffer(computer),
        disk(folder),
    ]
}

fn kernel(computer: &Computer) -> Finding {
    let version = computer.text("/proc/version").unwrap_or_default();
    let release = computer.text("/proc/sys/kernel/osrelease").unwrap_or_else(|| "unknown".to_owned());
    let is_preemptible =
        computer.text("/sys/kernel/realtime").as_deref() == Some("1") || version.contains("PREEMPT_RT");
    match is_preemptible {
        true => Finding::good("kernel", format!("Linux {release} with PREEMPT_RT")),
        false => Finding::warning(
            "kernel",
            format!("Linux {release} without PREEMPT_RT: drivers can delay the guard by milliseconds"),
            "install the real-time kernel, for example linux-image-rt-amd64 of Debian",
        ),
    }
}

fn real_time(computer: &Computer) -> Finding {
    match &computer.real_time {
        Ok(()) => Finding::good("real-time priority", "granted to the guard ring"),
        Err(reason) => Finding::bad(
            "real-time priority",
            format!("refused ({reason}): any other program can delay the guard"),
            "start it by packaging/systemd/floorguard.service, or set LimitRTPRIO=40 or `rtprio 40` in \
             /etc/security/limits.d for its user",
        ),
    }
}

fn processors(computer: &Computer) -> Finding {
    let names = computer.entries("/sys/devices/system/cpu");
    let is_processor = |name: &&String| {
        name.strip_prefix("cpu")
            .is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let count = names.iter().filter(is_processor).count();
    match count {
        0 => Finding::warning("processors", "not known", "/sys is not mounted"),
        count if count < PROCESSORS_MIN => Finding::warning(
            "processors",
            format!("{count}: guard, perception and mission share it"),
            format!("take a computer with {PROCESSORS_MIN} or more"),
        ),
        count => Finding::good("processors", count.to_string()),
    }
}

fn governor(computer: &Computer) -> Finding {
    match computer.text("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor") {
        None => Finding::good("processor frequency", "not changed by the kernel"),
        Some(governor) if governor == "performance" => Finding::good("processor frequency", governor),
        Some(governor) => Finding::warning(
            "processor frequency",
            format!("governor `{governor}`: slow until it has seen load"),
            "cpupower frequency-set --governor performance",
        ),
    }
}

fn clock(computer: &Computer) -> Finding {
    let now_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let is_synchronised = computer.exists(Path::new("/run/systemd/timesync/synchronized"))
        || computer.exists(Path::new("/run/chrony"));
    if now_s < CLOCK_MIN_S {
        return Finding::bad(
            "clock",
            "before 2025: the hours of the environment model and of the reports would be false",
            "set it, for example by systemd-timesyncd or a battery for the hardware clock",
        );
    }
    match is_synchronised {
        true => Finding::good("clock", "kept by a time service"),
        false => Finding::warning(
            "clock",
            "no time service found: reports and the environment model take the hour as it is",
            "systemctl enable --now systemd-timesyncd, or chrony",
        ),
    }
}

fn receive_buffer(computer: &Computer) -> Finding {
    let Some(bytes) = computer.number("/proc/sys/net/core/rmem_default") else {
        return Finding::warning("UDP receive buffer", "not known", "/proc is not mounted");
    };
    let holds_ms = bytes / BUFFERED_PACKET_BYTES * 1_000 / PACKETS_HZ;
    let found = format!("{bytes} bytes: {holds_ms} ms of lidar packets");
    match holds_ms >= BUFFER_MIN_MS {
        true => Finding::good("UDP receive buffer", found),
        false => Finding::warning(
            "UDP receive buffer",
            format!("{found}, wanted are {BUFFER_MIN_MS} ms"),
            "sysctl --write net.core.rmem_default=425984",
        ),
    }
}

fn disk(folder: &Path) -> Finding {
    let what = format!("free disk in {}", folder.display());
    match rustix::fs::statvfs(folder) {
        Err(error) => Finding::warning(what, format!("not known ({error})"), "name a folder that exists"),
        Ok(disk) => {
            let bytes = disk.f_bavail.saturating_mul(disk.f_frsize);
            let found = format!("{} GB", bytes / 1_000_000_000);
            match bytes >= DISK_MIN_BYTES {
                true => Finding::good(what, found),
                false => Finding::warning(
                    what,
                    format!("{found}: less than one hour of --record"),
                    "make room, or record less",
                ),
            }
        }
    }
}
