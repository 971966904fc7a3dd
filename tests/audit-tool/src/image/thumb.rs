//! Branches, calls and stack use of Thumb-2 code, enough of the instruction set for loops, call graph and frames.
//!
//! Encodings: ARMv7-M Architecture Reference Manual, A5 and A7. Frames are added up over the whole function, so code
//! that saves registers on two alternative paths is counted twice: never too small.

use std::collections::{BTreeMap, BTreeSet};

/// What one function does, as far as the audit cares.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Flow {
    /// Direct calls and tail jumps out of the function: (address of the call, target).
    pub calls: Vec<(u64, u64)>,
    /// Backward branches within the function: (branch address, target address).
    pub back_edges: Vec<(u64, u64)>,
    /// Addresses of calls through a register.
    pub indirect_calls: Vec<u64>,
    /// Bytes of stack that the function takes.
    pub frame_bytes: u32,
    /// Stack pointer moved by a register: the frame cannot be known.
    pub dynamic_frame: bool,
}

/// Decodes `code`, which starts at `start`. Literal pools must have been cut out by the caller: `is_data(address)`.
pub fn decode(code: &[u8], start: u64, is_data: impl Fn(u64) -> bool) -> Flow {
    let end = start + code.len() as u64;
    let mut flow = Flow::default();
    let mut edges = BTreeMap::new();
    let mut offset = 0;
    while offset + 2 <= code.len() {
        let address = start + offset as u64;
        let first = halfword(code, offset);
        if is_data(address) {
            offset += 2;
            continue;
        }
        let wide = first >> 11 >= 0b11101;
        let second = if wide && offset + 4 <= code.len() { halfword(code, offset + 2) } else { 0 };
        let table = || table_targets(code, start, address, (second & 0x10 != 0, &is_data));
        let next = if is_table_jump(first, second) { table() } else { successors(first, second, address) };
        edges.insert(address, next);
        if wide && offset + 4 <= code.len() {
            let skipped = wide_instruction(first, second, address, start..end, &mut flow);
            offset += 4 + skipped;
        } else {
            narrow_instruction(first, address, start..end, &mut flow);
            offset += 2;
        }
    }
    // A compiler also jumps back from a block that it moved out of the way; only a branch that its target can reach
    // again closes a loop.
    flow.back_edges.retain(|(branch, target)| reaches(&edges, *target, *branch));
    flow
}

/// Where control may go next within the function: nowhere for a return, everywhere for a table that cannot be read,
/// which can only show more loops.
enum Next {
    To(Vec<u64>),
    Anywhere,
}

fn successors(first: u16, second: u16, address: u64) -> Next {
    let wide = first >> 11 >= 0b11101;
    let (a, b) = (u32::from(first), u32::from(second));
    let after = address + if wide { 4 } else { 2 };
    let mut probe = Flow::default();
    // The whole address space is the function, so that every target is seen.
    if wide && first >> 11 == 0b11110 && b & 0x8000 != 0 && b & 0x4000 == 0 {
        branch_targets(a, b, address, &mut probe);
    } else if !wide {
        narrow_targets(first, address, &mut probe);
    }
    let target = probe.calls.first().map(|(_, target)| *target);
    let returns = first == 0x4770 || first >> 8 == 0xbd || (first == 0xe8bd && b & 0x8000 != 0);
    let unconditional = first >> 11 == 0b11100 || (wide && first >> 11 == 0b11110 && b & 0xd000 == 0x9000);
    match target {
        _ if returns => Next::To(Vec::new()),
        Some(target) if unconditional => Next::To(vec![target]),
        Some(target) => Next::To(vec![target, after]),
        None => Next::To(vec![after]),
    }
}

/// `tbb` or `tbh`.
fn is_table_jump(first: u16, second: u16) -> bool {
    first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000
}

/// Targets of the jump table behind `tbb` or `tbh` (A7.7.185): data up to the next code. What else lies in that data
/// gives targets that do not exist, which can only show more loops.
fn table_targets(
    code: &[u8],
    start: u64,
    address: u64,
    (halfwords, is_data): (bool, &impl Fn(u64) -> bool),
) -> Next {
    let base = address + 4;
    let length =
        (base..).step_by(2).take_while(|at| at - start < code.len() as u64 && is_data(*at)).count() * 2;
    let Some(table) = code.get((base - start) as usize..).and_then(|rest| rest.get(..length)) else {
        return Next::Anywhere;
    };
    let entries: Vec<u64> = if halfwords {
        table.chunks_exact(2).map(|pair| u64::from(u16::from_le_bytes([pair[0], pair[1]]))).collect()
    } else {
        table.iter().map(|byte| u64::from(*byte)).collect()
    };
    if entries.is_empty() {
        return Next::Anywhere;
    }
    Next::To(entries.iter().map(|entry| base + 2 * entry).collect())
}

/// Targets of a wide branch, reported as calls because no address is inside an empty function.
fn branch_targets(a: u32, b: u32, address: u64, probe: &mut Flow) {
    branch_or_call(a, b, address, &(0..0), probe);
}

fn narrow_targets(code: u16, address: u64, probe: &mut Flow) {
    narrow_instruction(code, address, 0..0, probe);
    // cbz and cbnz jump forwards only, but they can be on the way round a loop.
    if code & 0xf500 == 0xb100 {
        let offset = u64::from((code >> 9 & 1) << 6 | (code >> 3 & 0x1f) << 1);
        probe.calls.push((address, address + 4 + offset));
    }
}

fn reaches(edges: &BTreeMap<u64, Next>, from: u64, to: u64) -> bool {
    let mut seen = BTreeSet::new();
    let mut pending = vec![from];
    while let Some(address) = pending.pop() {
        if address == to {
            return true;
        }
        if !seen.insert(address) {
            continue;
        }
        match edges.get(&address) {
            Some(Next::To(targets)) => pending.extend(targets),
            Some(Next::Anywhere) => return true,
            None => {}
        }
    }
    false
}

fn halfword(code: &[u8], offset: usize) -> u16 {
    u16::from_le_bytes([code[offset], code[offset + 1]])
}

fn sign_extend(value: u32, bits: u32) -> i64 {
    let shift = 32 - bits;
    i64::from(((value << shift) as i32) >> shift)
}

fn jump(flow: &mut Flow, address: u64, displacement: i64, function: &std::ops::Range<u64>) {
    let target = (address + 4).wrapping_add_signed(displacement);
    if !function.contains(&target) {
        flow.calls.push((address, target));
    } else if target <= address {
        flow.back_edges.push((address, target));
    }
}

fn narrow_instruction(code: u16, address: u64, function: std::ops::Range<u64>, flow: &mut Flow) {
    let wide = u32::from(code);
    if code >> 12 == 0b1101 && (code >> 8) & 0xf < 0xe {
        jump(flow, address, sign_extend((wide & 0xff) << 1, 9), &function);
    } else if code >> 11 == 0b11100 {
        jump(flow, address, sign_extend((wide & 0x7ff) << 1, 12), &function);
    } else if code & 0xff07 == 0x4700 && code != 0x4770 {
        // blx rm, or bx rm other than the return bx lr
        flow.indirect_calls.push(address);
    } else if code >> 9 == 0b1011010 {
        flow.frame_bytes += 4 * (wide & 0x1ff).count_ones();
    } else if code >> 7 == 0b1_0110_0001 {
        flow.frame_bytes += 4 * (wide & 0x7f);
    } else if code & 0xff87 == 0x4485 {
        // add sp, rm
        flow.dynamic_frame = true;
    }
}

/// Returns how many bytes of inline jump table follow.
fn wide_instruction(
    first: u16,
    second: u16,
    address: u64,
    function: std::ops::Range<u64>,
    flow: &mut Flow,
) -> usize {
    let (a, b) = (u32::from(first), u32::from(second));
    if first >> 11 == 0b11110 && b & 0x8000 != 0 {
        branch_or_call(a, b, address, &function, flow);
    } else if first == 0xe92d {
        flow.frame_bytes += 4 * b.count_ones();
    } else if first & 0xfbff == 0xf1ad && b & 0x0f00 == 0x0d00 {
        flow.frame_bytes += modified_immediate(a, b);
    } else if first & 0xfbff == 0xf2ad && b & 0x0f00 == 0x0d00 {
        flow.frame_bytes += immediate12(a, b);
    } else if first & 0xffbf == 0xed2d && b & 0x0e00 == 0x0a00 {
        flow.frame_bytes += 4 * (b & 0xff);
    } else if first == 0xf84d && b & 0x0f00 == 0x0d00 {
        flow.frame_bytes += b & 0xff;
    } else if first == 0xebad && b & 0x0f00 == 0x0d00 {
        flow.dynamic_frame = true;
    }
    0
}

fn branch_or_call(a: u32, b: u32, address: u64, function: &std::ops::Range<u64>, flow: &mut Flow) {
    let (s, j1, j2) = ((a >> 10) & 1, (b >> 13) & 1, (b >> 11) & 1);
    let long = || {
        let (i1, i2) = (1 ^ j1 ^ s, 1 ^ j2 ^ s);
        sign_extend((s << 24) | (i1 << 23) | (i2 << 22) | ((a & 0x3ff) << 12) | ((b & 0x7ff) << 1), 25)
    };
    match (b >> 12) & 0b101 {
        0b101 => flow.calls.push((address, (address + 4).wrapping_add_signed(long()))),
        0b001 => jump(flow, address, long(), function),
        0b000 if (a >> 6) & 0xf < 0xe => {
            let value = (s << 20) | (j2 << 19) | (j1 << 18) | ((a & 0x3f) << 12) | ((b & 0x7ff) << 1);
            jump(flow, address, sign_extend(value, 21), function);
        }
        _ => {}
    }
}

fn immediate12(a: u32, b: u32) -> u32 {
    (((a >> 10) & 1) << 11) | (((b >> 12) & 7) << 8) | (b & 0xff)
}

/// ThumbExpandImm (A5.3.2).
fn modified_immediate(a: u32, b: u32) -> u32 {
    let packed = immediate12(a, b);
    let byte = packed & 0xff;
    match packed >> 8 {
        0 => byte,
        1 => byte | (byte << 16),
        2 => (byte << 8) | (byte << 24),
        3 => byte | (byte << 8) | (byte << 16) | (byte << 24),
        _ => (0x80 | (packed & 0x7f)).rotate_right(packed >> 7),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow(code: &[u16]) -> Flow {
        let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
        decode(&bytes, 0x1000, |_| false)
    }

    /// Encodings assembled with `arm-none-eabi-as` 2.40.
    #[test]
    fn reads_branches_calls_and_frames() {
        // push {r4, r5, lr}; sub sp, #16; 1: subs r0, #1; bne 1b; add sp, #16; pop {r4, r5, pc}
        let looped = flow(&[0xb530, 0xb084, 0x3801, 0xd1fd, 0xb004, 0xbd30]);
        assert_eq!(looped.frame_bytes, 12 + 16);
        assert_eq!(looped.back_edges, [(0x1006, 0x1004)]);
        // stmdb sp!, {r4-r9, lr}; vpush {d8, d9}; sub.w sp, sp, #4096; bl .+0x100; bx lr
        let framed = flow(&[0xe92d, 0x43f0, 0xed2d, 0x8b04, 0xf5ad, 0x5d80, 0xf000, 0xf87e, 0x4770]);
        assert_eq!(framed.frame_bytes, 28 + 16 + 4096);
        assert_eq!(framed.calls, [(0x100c, 0x100c + 4 + 0xfc)]);
        // b 2f; 1: bx lr; 2: b 1b: a jump back that is no loop.
        assert_eq!(flow(&[0xe000, 0x4770, 0xe7fd]).back_edges, []);
        // bne.w 1b with 1b two halfwords before; blx r3
        // b 2f; 1: movs r0, #0; bx lr; b 1b; 2: tbb [pc, r1] with a table; 3: b 2b; 4: bx lr. Going round needs an
        // entry for 3.
        let tabled = |entries: u16| {
            let code = [0xe002_u16, 0x2000, 0x4770, 0xe7fc, 0xe8df, 0xf001, entries, 0xe7fb, 0x4770];
            let bytes: Vec<u8> = code.iter().flat_map(|half| half.to_le_bytes()).collect();
            decode(&bytes, 0x1000, |at| at == 0x100c).back_edges
        };
        assert_eq!(tabled(0x0202), []);
        assert_eq!(tabled(0x0102), [(0x100e, 0x1008)]);
        let conditional = flow(&[0xbf00, 0xbf00, 0xf47f, 0xaffc, 0x4798]);
        assert_eq!(conditional.back_edges, [(0x1004, 0x1000)]);
        assert_eq!(conditional.indirect_calls, [0x1008]);
    }
}
