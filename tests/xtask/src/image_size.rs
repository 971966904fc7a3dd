//! How large an image of the firmware is, and how much stack it needs.

use std::path::Path;

use anyhow::Result;
use serde::{Deserialize, Serialize};

use crate::stack;

/// Bytes of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Size {
    /// Program and constants.
    pub flash_bytes: u64,
    /// Statics.
    pub ram_bytes: u64,
    /// The deepest stack, start-up included; 0: not asked.
    pub stack_bytes: u64,
    /// The black box across resets, in a memory of its own.
    #[serde(default)]
    pub kept_bytes: u64,
    /// Statics in the chip's tightly coupled memory.
    #[serde(default)]
    pub coupled_bytes: u64,
}

/// The size of an image; its stack where the interrupt handlers are given.
pub fn measure(image: &Path, handlers: Option<&[&[&str]]>) -> Result<Size> {
    let size = sizes(image)?;
    let stack_bytes = match handlers {
        Some(handlers) => {
            let need = stack::need(image, handlers)?;
            let stack::Need { start, task, interrupts } = need;
            println!(
                "firmware: stack: start-up {start} bytes, a task {task}, interrupts above it {interrupts}"
            );
            u64::from(need.most())
        }
        None => 0,
    };
    Ok(Size { stack_bytes, ..size })
}

/// Bytes of program and constants, of statics, and of what is kept across resets; not of the stack.
fn sizes(image: &Path) -> Result<Size> {
    use object::{Object, ObjectSection, SectionKind};
    let bytes = std::fs::read(image)?;
    let file = object::File::parse(&*bytes)?;
    let mut size = Size::default();
    for section in file.sections() {
        match section.kind() {
            // Constants that the linker may join are a kind of their own.
            SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => {
                size.flash_bytes += section.size();
            }
            // Initial values lie in flash and are copied.
            SectionKind::Data => {
                size.flash_bytes += section.size();
                size.ram_bytes += section.size();
            }
            SectionKind::UninitializedData if section.name() == Ok(".kept") => {
                size.kept_bytes += section.size()
            }
            SectionKind::UninitializedData if section.name() == Ok(".dtcm") => {
                size.coupled_bytes += section.size()
            }
            SectionKind::UninitializedData => size.ram_bytes += section.size(),
            _ => {}
        }
    }
    Ok(size)
}
