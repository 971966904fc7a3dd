//! The emulator with its sockets.

use std::net::UdpSocket;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use anyhow::Context;

use super::line::Line;

/// The board's PSRAM holds the tape with the route, and the options behind it.
const TAPE_AT: u32 = 0x6000_0000;
const OPTIONS_AT: u32 = 0x60ff_ff00;
/// "FGOP", never sleep.
const OPTIONS: [u32; 2] = [0x504f_4746, 1];
/// Ports of the firmware.
const LIDAR_PORT: u16 = 2_368;
const BENCH_PORT: u16 = 2_369;
/// A silent board is a dead one.
const SILENT_AFTER: Duration = Duration::from_secs(60);

/// A running board.
pub struct Board {
    emulator: Child,
    /// Lidar datagrams go here.
    pub lidar: UdpSocket,
    /// Reports come from here.
    pub bench: UdpSocket,
    /// The safety scanner's line.
    pub scanner: Line,
    /// The inertial sensor's line.
    pub imu: Line,
    /// The CAN adapter's line.
    pub can: Line,
    /// Who asks here for the black box gets it.
    pub black_box: PathBuf,
    /// The output of the board's log.
    pub log: PathBuf,
}

/// Ports that nobody has; another process may take one meanwhile, then the emulator says so.
fn free_port() -> anyhow::Result<u16> {
    Ok(UdpSocket::bind("127.0.0.1:0")?.local_addr()?.port())
}

fn connected(port: u16) -> anyhow::Result<UdpSocket> {
    let socket = UdpSocket::bind("127.0.0.1:0")?;
    socket.connect(("127.0.0.1", port))?;
    socket.set_read_timeout(Some(SILENT_AFTER))?;
    Ok(socket)
}

impl Board {
    /// Starts an image; `fault` is what it breaks on purpose, 0 = nothing. `folder` takes the sockets.
    ///
    /// # Errors
    /// The emulator does not start.
    pub fn start(image: &Path, tape: &[u8], fault: u32, folder: &Path) -> anyhow::Result<Self> {
        let tape_path = folder.join("route.tape");
        std::fs::write(&tape_path, tape)?;
        let (lidar_port, bench_port) = (free_port()?, free_port()?);
        let mut command = Command::new("qemu-system-arm");
        command.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"]);
        command.args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=1,sleep=off"]);
        let forward = |host, board| format!("hostfwd=udp:127.0.0.1:{host}-:{board}");
        let (lidar, bench) = (forward(lidar_port, LIDAR_PORT), forward(bench_port, BENCH_PORT));
        command.arg("-nic").arg(format!("user,{lidar},{bench}"));
        command.arg("-echr").arg("256");
        let sockets: Vec<PathBuf> =
            ["scanner", "imu", "can"].iter().map(|name| folder.join(format!("{name}.socket"))).collect();
        for (index, path) in sockets.iter().enumerate() {
            // The multiplexer adds a buffer, without which each byte costs a round trip of the emulator's main loop.
            command.arg("-chardev");
            command.arg(format!("socket,id=line{index},path={},server=on,wait=on,mux=on", path.display()));
            command.arg("-serial").arg(format!("chardev:line{index}"));
        }
        let (log, black_box) = (folder.join("log.defmt"), folder.join("black_box.socket"));
        command.arg("-chardev").arg(format!("file,id=log,path={}", log.display()));
        command.args(["-serial", "chardev:log"]);
        command.arg("-chardev");
        command.arg(format!("socket,id=box,path={},server=on,wait=off", black_box.display()));
        command.args(["-serial", "chardev:box"]);
        command.arg("-device");
        command.arg(format!("loader,file={},addr={TAPE_AT:#x},force-raw=on", tape_path.display()));
        for (index, word) in OPTIONS.into_iter().chain([fault]).enumerate() {
            let at = OPTIONS_AT + 4 * index as u32;
            command.arg("-device").arg(format!("loader,addr={at:#x},data={word:#x},data-len=4"));
        }
        // It tells that it waits for us.
        command.arg("-kernel").arg(image).stdin(Stdio::null()).stderr(Stdio::null());
        let emulator = command.spawn().context("cannot start qemu-system-arm")?;
        let mut board = Opening(Some(emulator));
        let [scanner, imu, can] = sockets.as_slice() else { unreachable!("three lines") };
        let (scanner, imu, can) =
            (Line::open(scanner, 50_000)?, Line::open(imu, 11_520)?, Line::open(can, 100_000)?);
        let (lidar, bench) = (connected(lidar_port)?, connected(bench_port)?);
        let emulator = board.0.take().context("the emulator was started")?;
        Ok(Self { emulator, lidar, bench, scanner, imu, can, black_box, log })
    }

    /// Tells the firmware to end, and waits for it.
    ///
    /// # Errors
    /// It ends otherwise than it should.
    pub fn quit(mut self) -> anyhow::Result<()> {
        for _ in 0..300 {
            self.bench.send(b"Q")?;
            std::thread::sleep(Duration::from_millis(100));
            if let Some(status) = self.emulator.try_wait()? {
                anyhow::ensure!(status.success(), "the firmware failed: {status}");
                return Ok(());
            }
        }
        anyhow::bail!("the firmware does not quit")
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.emulator.kill();
        let _ = self.emulator.wait();
    }
}

/// Ends the emulator where its lines cannot be opened.
struct Opening(Option<Child>);

impl Drop for Opening {
    fn drop(&mut self) {
        if let Some(mut emulator) = self.0.take() {
            let _ = emulator.kill();
            let _ = emulator.wait();
        }
    }
}
