//! The chip's CAN controller as the bus that the tasks know.

use embassy_stm32::can::{Can, Frame, enums::BusError};
use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::CanBus;

/// FDCAN1, classic frames.
pub struct FdcanBus(pub Can<'static>);

impl CanBus for FdcanBus {
    type Error = BusError;

    async fn receive(&mut self) -> Result<CanFrame, BusError> {
        loop {
            let frame = self.0.read().await?.frame;
            // The robot's devices speak with 11 bits only.
            if let embedded_can::Id::Standard(id) = frame.id() {
                return Ok(CanFrame::standard(id.as_raw(), frame.data()));
            }
        }
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), BusError> {
        let Some(id) = frame.standard_id() else { return Err(BusError::Software) };
        let frame = Frame::new_standard(id, frame.payload()).map_err(|_| BusError::Software)?;
        // A frame that was pushed out of the mailboxes is repeated by its protocol.
        let _ = self.0.write(&frame).await;
        Ok(())
    }
}
