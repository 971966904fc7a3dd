//! Memory protection below the stack: a stack that grows too far faults instead of writing over statics.

use cortex_m::peripheral::MPU;

/// Bytes that nobody may touch; space for the fault's own frames, which the protection does not stop.
const GUARD_BYTES: u32 = 1_024;
/// log2 of the size, minus one: what the register wants.
const SIZE_FIELD: u32 = GUARD_BYTES.ilog2() - 1;
/// Region on; no access; never execute.
const REGION: u32 = 1 << 28 | SIZE_FIELD << 1 | 1;
/// Protection on; elsewhere the usual map. Off in faults, so that they can tell.
const CONTROL: u32 = 1 << 2 | 1;

unsafe extern "C" {
    /// End of the statics, from the linker script.
    static __sheap: u8;
}

/// Switches the protection on. Call once, first.
pub fn start() {
    // SAFETY: only the address is taken.
    let statics_end = (&raw const __sheap).addr() as u32;
    let guard = statics_end.next_multiple_of(GUARD_BYTES);
    // SAFETY: called once, before interrupts, by the only core; the region holds no static and the stack is far above.
    unsafe {
        let mpu = &*MPU::PTR;
        mpu.rnr.write(0);
        mpu.rbar.write(guard);
        mpu.rasr.write(REGION);
        mpu.ctrl.write(CONTROL);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}
