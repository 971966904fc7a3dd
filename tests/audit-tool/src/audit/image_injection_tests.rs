//! Each kind of mistake that survives into compiled code makes the audit fail and names its line.
//!
//! The images are little ones of a single file, compiled as the safety image is: seconds instead of minutes.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::claim::Claim;
use crate::facts::facts;
use crate::image::{Image, roots};
use crate::loops::LoopSite;
use crate::sources::SourceFile;
use crate::{image, loops, shell, sources};

/// Where the example would lie in our layers.
const EXAMPLE: &str = "core-nostd/guard/src/example.rs";

/// What surrounds the example, and keeps the linker from throwing it away.
const MAIN: &str = r#"#![no_std]
#![no_main]
#[path = "core-nostd/guard/src/example.rs"]
mod example;
#[panic_handler]
fn floorguard_panics(_: &core::panic::PanicInfo) -> ! { loop {} }
#[unsafe(no_mangle)]
pub extern "C" fn entry(data: &mut [u32; 16], number: usize) -> u32 { root_example(data, number) }
#[inline(never)]
pub fn root_example(data: &mut [u32; 16], number: usize) -> u32 { example::stage(data, number) }
"#;

/// A heap that gives nothing.
const HEAP: &str = "extern crate alloc;
struct Heap;
unsafe impl core::alloc::GlobalAlloc for Heap {
    unsafe fn alloc(&self, _: core::alloc::Layout) -> *mut u8 { 0x2000_0000 as *mut u8 }
    unsafe fn dealloc(&self, _: *mut u8, _: core::alloc::Layout) {}
}
#[global_allocator]
static HEAP: Heap = Heap;
";

struct Compiled {
    image: Image,
    files: Vec<SourceFile>,
}

fn compiled(code: &str, more: &str) -> Compiled {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::create_dir_all(folder.join("core-nostd/guard/src")).expect("a folder");
    fs::write(folder.join(EXAMPLE), code).expect("it is written");
    fs::write(folder.join("main.rs"), format!("{MAIN}{more}")).expect("it is written");
    link(folder);
    let image = image::read(&folder.join("image")).expect("an image");
    let files = vec![sources::parse(EXAMPLE, code.to_owned()).expect("the example parses")];
    Compiled { image, files }
}

fn link(folder: &Path) {
    let root = shell::root();
    let mut command = Command::new("rustc");
    command.current_dir(&root).arg(folder.join("main.rs")).arg("-o").arg(folder.join("image"));
    command.args([
        "--edition",
        "2024",
        "--target",
        &facts().image.target,
        "--crate-type",
        "bin",
        "--cap-lints",
        "allow",
    ]);
    command.arg(format!("--remap-path-prefix={}={}", folder.display(), root.display()));
    let options = ["target-cpu=cortex-m7", "opt-level=3", "panic=abort", "debuginfo=line-tables-only"];
    let linked = ["link-arg=--entry=entry", "link-arg=--gc-sections", "link-arg=-Ttext=0x20000"];
    command.args(options.iter().chain(&linked).flat_map(|option| ["-C", option]));
    let output = command.output().expect("rustc starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The claims on the image, the listed loops of the example's sources given.
fn claims(compiled: &Compiled, listed: bool) -> Vec<Claim> {
    let sites: Vec<LoopSite> = compiled.files.iter().flat_map(|file| loops::list(file).0).collect();
    let roots = roots::in_text("main.rs", MAIN.to_owned()).expect("it parses");
    image::claims::judge(&compiled.image, &compiled.files, if listed { &sites } else { &[] }, &roots)
}

/// The claim fails at this line of the example.
fn names_line(claims: &[Claim], id: &str, line: usize, words: &str) {
    names_lines(claims, id, line..=line, words);
}

/// The same where the compiler chooses the line of a loop or of a function that it tells.
fn names_lines(claims: &[Claim], id: &str, lines: std::ops::RangeInclusive<usize>, words: &str) {
    let claim = claims.iter().find(|claim| claim.id == id).expect("a claim");
    let named =
        claim.findings.iter().find(|finding| finding.place == EXAMPLE && lines.contains(&finding.line));
    assert!(named.is_some_and(|finding| finding.message.contains(words)), "{id}: {:?}", claim.findings);
}

#[test]
fn clean_image_passes_each_mistake_is_named() {
    let clean = "pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    let mut sum = number as u32;
    for step in 0..number.min(64) {
        data[0] = data[0].wrapping_mul(sum | step as u32);
        sum = sum.rotate_left(data[0] & 7);
    }
    sum
}";
    let image = compiled(clean, "");
    let failing: Vec<Claim> = claims(&image, true).into_iter().filter(|claim| !claim.holds()).collect();
    assert!(failing.is_empty(), "{failing:?}");
    // The same code, but nobody listed its loop.
    names_lines(&claims(&image, false), "loops-complete", 3..=6, "is in no list");
}

#[test]
fn a_panic_that_the_optimiser_leaves_is_named() {
    let code = "pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {

    data[number]
}";
    names_line(&claims(&compiled(code, ""), true), "no-panic-linked", 3, "panic_bounds_check");
}

#[test]
fn inlined_heap_use_is_named() {
    let code = "pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    let mut kept = alloc::vec::Vec::with_capacity(number & 15);
    kept.push(number as u32);
    data.iter().chain(&kept).fold(0, |a, b| a ^ b)
}";
    let code = format!("extern crate alloc;\n{code}");
    names_line(&claims(&compiled(&code, HEAP), true), "no-heap-linked", 3, "uses the heap");
}

#[test]
fn recursion_is_named() {
    let code = "#[inline(never)]
pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    if number == 0 { return data[0]; }
    data[1] = stage(data, number >> 1);
    data[1].wrapping_mul(stage(data, number >> 2))
}";
    let claims = claims(&compiled(code, ""), true);
    names_line(&claims, "no-recursion-linked", 2, "calls itself");
}

#[test]
fn a_circle_of_two_functions_is_named() {
    let code = "pub fn stage(data: &mut [u32; 16], number: usize) -> u32 { even(data, number) }
#[inline(never)]
fn even(data: &mut [u32; 16], number: usize) -> u32 {
    if number == 0 { return 1; }
    data[0] = odd(data, number - 1);
    data[0] ^ 3
}
#[inline(never)]
fn odd(data: &mut [u32; 16], number: usize) -> u32 {
    if number == 0 { return 0; }
    data[1] = even(data, number - 1);
    data[1] ^ 5
}";
    names_lines(&claims(&compiled(code, ""), true), "no-recursion-linked", 3..=7, "even");
}

#[test]
fn a_call_through_a_register_is_named() {
    let code = "type Work = fn(u32) -> u32;
static WORK: [Work; 2] = [twice, thrice];
#[inline(never)]
fn twice(a: u32) -> u32 { a.wrapping_mul(2) }
#[inline(never)]
fn thrice(a: u32) -> u32 { a.wrapping_mul(3) }
#[inline(never)]
pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    WORK[number & 1](data[0]) ^ 1
}";
    names_line(&claims(&compiled(code, ""), true), "no-indirect-calls-linked", 8, "through a register");
}

#[test]
fn a_frame_over_budget_is_named() {
    let code = "#[inline(never)]
pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    let mut room = [0u32; 2_100];
    for (cell, value) in room.iter_mut().zip(data.iter()) { *cell = *value; }
    core::hint::black_box(&mut room)[7] ^ number as u32
}";
    let claims = claims(&compiled(code, ""), true);
    names_line(&claims, "stack-budget", 2, "8192 B");
}

#[test]
fn loop_waiting_for_a_sensor_is_named() {
    let code = "pub fn stage(data: &mut [u32; 16], number: usize) -> u32 {
    let mut turns = number as u32;
    while core::hint::black_box(data[0]) & 1 == 0 {
        turns = turns.wrapping_add(1);
    }
    turns
}";
    names_line(&claims(&compiled(code, ""), true), "loops-complete", 3, "is in no list");
}
