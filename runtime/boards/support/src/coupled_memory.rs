//! Statics in tightly coupled memory begin as zeros, as all others do.

use core::arch::global_asm;

// Called before the first push, so without a stack; whole double words, for which the chip's error correction keeps a code.
global_asm!(
    ".section .text.__zero_dtcm, \"ax\"",
    ".global __zero_dtcm",
    ".type __zero_dtcm, %function",
    ".thumb_func",
    "__zero_dtcm:",
    "ldr r0, =__sdtcm",
    "ldr r1, =__edtcm",
    "movs r2, #0",
    "movs r3, #0",
    "1:",
    "cmp r0, r1",
    "bhs 2f",
    "strd r2, r3, [r0], #8",
    "b 1b",
    "2:",
    "bx lr",
);
