//! The robot's configuration as constants.

use std::path::{Path, PathBuf};

use anyhow::Context;
use floorguard_configuration::{ScannerAddress, bake, load};
use floorguard_runtime::configuration::{ImuModel, LidarModel};

fn main() -> anyhow::Result<()> {
    println!("cargo:rerun-if-changed=../../../robot.toml");
    println!("cargo:rerun-if-changed=build.rs");
    // What the log tells; without this only errors.
    println!("cargo:rustc-env=DEFMT_LOG=info");
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").context("cargo gives OUT_DIR")?);
    // The same checks as on the robot's computer: a wrong file stops the build with its line and the remedy.
    let configuration = load(Path::new("../../../robot.toml"))?;
    let (_, gaps) = configuration.coverage();
    if let Some(gap) = gaps.first() {
        anyhow::bail!("robot.toml: {gap}; `floorguard check robot.toml` lists all gaps");
    }
    let robot = configuration.robot;
    // The capacities of this profile are not the host's, whose check has just passed.
    anyhow::ensure!(
        matches!(configuration.carriers.scanner, ScannerAddress::Serial(_)),
        "robot.toml: [scanner] {:?}: the boards have memory for the 541 beams of an S300 and no task for datagrams; \
         write model = \"s300\", or run this robot on Linux",
        robot.scanner.model
    );
    anyhow::ensure!(
        !matches!(
            robot.lidar.model,
            LidarModel::PandarXt16
                | LidarModel::PandarXt32
                | LidarModel::Ouster(_)
                | LidarModel::Bridged(_)
                | LidarModel::LivoxMid360(_)
        ),
        "robot.toml: [lidar] the boards decode Velodyne lidars only; write model = \"vlp16\", or run this robot on Linux"
    );
    anyhow::ensure!(
        robot.imu.is_none_or(|imu| imu.model == ImuModel::XsensMti),
        "robot.toml: [imu] the boards speak with an Xsens MTi only; write model = \"xsens-mti\", or run this robot on Linux"
    );
    // So that the board need not be able to say what is wrong.
    let refused = |error| anyhow::anyhow!("the guard refuses robot.toml: {error}");
    robot.guard().validate().map_err(refused)?;
    std::fs::write(folder.join("robot.rs"), bake(&robot))?;
    Ok(())
}
