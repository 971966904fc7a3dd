//! A CAN bus in the same process, for the virtual world.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::rc::Rc;
use std::task::{Poll, Waker};

use floorguard_drivers::can::CanFrame;
use floorguard_runtime::io::CanBus;

/// Frames held for a late reader: the kernel's socket buffer holds about as many.
const FRAMES_MAX: usize = 1_024;

#[derive(Default)]
struct Shared {
    to_robot: VecDeque<CanFrame>,
    from_robot: Vec<CanFrame>,
    reader: Option<Waker>,
    lost: u64,
}

/// Both ends of the bus. Clones share it.
#[derive(Clone, Default)]
pub struct CanPipe(Rc<RefCell<Shared>>);

impl CanPipe {
    /// A device sends a frame to the robot's computer.
    pub fn push(&self, frame: CanFrame) {
        let shared = &mut *self.0.borrow_mut();
        if shared.to_robot.len() >= FRAMES_MAX {
            shared.lost += 1;
        } else {
            shared.to_robot.push_back(frame);
        }
        if let Some(reader) = shared.reader.take() {
            reader.wake();
        }
    }

    /// What the robot's computer has sent since the last call.
    #[must_use]
    pub fn drain(&self) -> Vec<CanFrame> {
        std::mem::take(&mut self.0.borrow_mut().from_robot)
    }

    /// Frames that found the buffer full.
    #[must_use]
    pub fn lost(&self) -> u64 {
        self.0.borrow().lost
    }
}

impl CanBus for CanPipe {
    type Error = Infallible;

    async fn receive(&mut self) -> Result<CanFrame, Infallible> {
        core::future::poll_fn(|context| {
            let shared = &mut *self.0.borrow_mut();
            match shared.to_robot.pop_front() {
                Some(frame) => Poll::Ready(Ok(frame)),
                None => {
                    shared.reader = Some(context.waker().clone());
                    Poll::Pending
                }
            }
        })
        .await
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), Infallible> {
        self.0.borrow_mut().from_robot.push(*frame);
        Ok(())
    }
}
