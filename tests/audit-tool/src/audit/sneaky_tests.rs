//! Mistakes in every disguise that came to mind, each put into a file of the core and into one of the drivers: the audit
//! must fail under the right claim and name the line, and nothing else.

use crate::audit::run::judge_sources;
use crate::claim::Claim;
use crate::{shell, sources};

/// A file of each layer, and a line within a function before which a statement can be put.
const HOSTS: &[(&str, &str)] = &[
    ("core-nostd/guard/src/supervisor.rs", "        let mut accepted = false;"),
    ("drivers/src/s300/receiver.rs", "        let mut rest = bytes;"),
];

/// Claims that the tree fails with the statement, each with the lines that its findings name.
fn failing((path, place): (&str, &str), statement: &str) -> (usize, Vec<(&'static str, usize)>) {
    let text = std::fs::read_to_string(shell::root().join(path)).expect("the file is there");
    assert_eq!(text.matches(place).count(), 1, "`{place}` must stand once in {path}");
    let line = text.split(place).next().map_or(0, |before| before.matches('\n').count() + 1);
    let corrupted = text.replace(place, &format!("{statement}\n{place}"));
    let file = sources::parse(path, corrupted).unwrap_or_else(|error| panic!("`{statement}`: {error}"));
    let (claims, _) = judge_sources(&[file]);
    let named = |claim: &Claim| claim.findings.iter().map(|found| (claim.id, found.line)).collect::<Vec<_>>();
    let mut found: Vec<_> = claims.iter().flat_map(named).collect();
    found.dedup();
    (line, found)
}

/// Each statement makes `claim` fail at its line, in both layers.
fn refused(claim: &str, statements: &[&str]) {
    for host in HOSTS {
        assert_eq!(failing(*host, "let harmless = 1;").1, [], "the unmodified file must hold");
        for statement in statements {
            let (line, found) = failing(*host, statement);
            assert!(found.contains(&(claim, line)), "`{statement}` in {}: {found:?}", host.0);
            assert!(found.iter().all(|(_, at)| *at == line), "`{statement}` in {}: {found:?}", host.0);
        }
    }
}

/// Statements that look like mistakes and are none.
fn allowed(statements: &[&str]) {
    for (host, statement) in HOSTS.iter().flat_map(|host| statements.iter().map(move |text| (host, text))) {
        let (_, found) = failing(*host, statement);
        assert_eq!(found, [], "`{statement}` in {}", host.0);
    }
}

#[test]
fn loops_that_may_never_end_are_refused() {
    refused(
        "loops-bounded",
        &[
            "for turn in 0..reading.count {}",
            "for turn in 0.. {}",
            "loop { if bytes.is_empty() { break; } }",
            "while reading.value() < 3.0 {}",
            "while let Some(byte) = source.next() {}",
            "async { loop { if ready { source.read().await; } } };",
            "for turn in core::iter::repeat(1) {}",
            "for turn in core::iter::repeat::<u8>(1) {}",
            "let sum: u32 = core::iter::from_fn(read).sum();",
            "let later = core::iter::repeat_with(read); helper(later);",
            "let later = core::iter::repeat_with(read); list.extend(later);",
            "core::iter::successors(Some(1), next).for_each(drop);",
            "list.iter().cycle().for_each(drop);",
            "list.extend(core::iter::repeat(1));",
            "list.extend(0..reading.count);",
            "for turn in core::iter::repeat(1).zip(core::iter::repeat(2)) {}",
            "for turn in (0..).zip(0..reading.count) {}",
            "for turn in list.iter().chain(core::iter::repeat(&1)) {}",
            "for turn in core::iter::repeat_n(1, reading.count) {}",
            "for turn in core::iter::repeat(1).take(reading.count) {}",
        ],
    );
}

#[test]
fn loops_with_hidden_bounds_are_refused() {
    refused(
        "loops-bounded",
        &[
            "let LIMIT = reading.count; for turn in 0..LIMIT {}",
            "let turns = 0..; for turn in turns {}",
            "let turns = 0..reading.count; for turn in turns {}",
            "let mut turns = 0..4; turns = 0..reading.count; for turn in turns {}",
            "let turns = (0..).map(double); for turn in turns {}",
            "let walk = |turns: core::ops::Range<usize>| for turn in turns {};",
            "fn walk(turns: core::ops::Range<usize>) { for turn in turns {} }",
            "helper(0..);",
            "let own = Window { turns: 0..reading.count };",
            "struct Endless; impl Iterator for Endless { type Item = u8; }",
        ],
    );
}

#[test]
fn loops_within_macros_are_refused() {
    refused(
        "loops-bounded",
        &[
            "write!(out, \"{}\", loop {});",
            "write!(out, \"{}\", list.iter().cycle().count());",
            "macro_rules! spin { () => { loop {} }; }",
            "macro_rules! spin { ($n:expr) => { for turn in 0..$n {} }; }",
        ],
    );
}

#[test]
fn loops_that_end_are_allowed() {
    allowed(&[
        "for turn in core::iter::repeat(1).take(BUFFER_BYTES) {}",
        "for (turn, byte) in (0..).zip(bytes) {}",
        "for pair in list.iter().zip(core::iter::repeat(1)) {}",
        "let numbers = 0..; for pair in list.iter().zip(numbers) {}",
        "let inside = (0..reading.count).contains(&3);",
        "let part = list.get(reading.count..);",
        "if matches!(reading.count, 3..) {}",
        "let filled: [u8; 4] = core::array::from_fn(|at| at as u8);",
        "write!(out, \"{}\", list.iter().count());",
    ]);
}

#[test]
fn the_heap_is_refused_in_every_disguise() {
    refused(
        "no-heap-in-sources",
        &[
            "let list = vec![1];",
            "let text = format!(\"{}\", 1);",
            "let text = alloc::format!(\"{}\", 1);",
            "let list: alloc::vec::Vec<u8> = later();",
            "use alloc::vec::Vec as List;",
            "extern crate alloc;",
            "let list = std::vec::Vec::<u8>::new();",
            "let owned = Box::new(1);",
            "let names = list.iter().map(String::from);",
            "let set = list.iter().collect::<alloc::collections::BTreeSet<_>>();",
            "macro_rules! grow { () => { Box::new(1) }; }",
        ],
    );
}

#[test]
fn growing_vec_is_refused_without_fixed_import() {
    for statement in ["let list = Vec::<u8>::new();", "let list: Vec<u8> = bytes.iter().copied().collect();"]
    {
        for host in HOSTS {
            let (line, found) = failing(*host, &format!("// heapless\n{statement}"));
            assert_eq!(found, [("no-heap-in-sources", line + 1)], "`{statement}` in {}", host.0);
        }
    }
    allowed(&["let list = heapless::Vec::<u8, 4>::new();"]);
}

#[test]
fn panics_are_refused_in_every_disguise() {
    refused(
        "no-panic-in-sources",
        &[
            "let value = reading.unwrap();",
            "let value = reading.expect(\"there\");",
            "let value = Option::unwrap(reading);",
            "let values = list.iter().map(Option::unwrap);",
            "let error = reading.unwrap_err();",
            "panic!();",
            "unreachable!();",
            "assert!(ready);",
            "let value = list[at];",
            "let value = list[at + 1];",
            "let part = &list[at..];",
            "let part = &list[..reading.count];",
            "list[0][at] = 1;",
            "target.copy_from_slice(source);",
            "target.clone_from_slice(source);",
            "write!(out, \"{}\", reading.unwrap());",
            "macro_rules! sure { ($x:expr) => { $x.unwrap() }; }",
        ],
    );
    allowed(&[
        "let value = list[0];",
        "let value = list[FIRST];",
        "let value = reading.unwrap_or(3);",
        "const _: () = assert!(BUFFER_BYTES > 3);",
    ]);
}

#[test]
fn unsafe_code_is_refused_in_every_disguise() {
    refused(
        "no-unsafe",
        &[
            "let value = unsafe { *pointer };",
            "unsafe fn quick() {}",
            "unsafe impl Send for Thing {}",
            "unsafe trait Trusted {}",
            "static mut COUNT: u32 = 0;",
            "extern \"C\" { fn outside(); }",
            "unsafe extern \"C\" { fn outside(); }",
            "#[unsafe(no_mangle)] fn outside() {}",
            "core::arch::asm!(\"nop\");",
            "write!(out, \"{}\", unsafe { *pointer });",
            "const VALUE: u8 = unsafe { later() };",
            "macro_rules! quick { ($x:expr) => { unsafe { $x } }; }",
        ],
    );
}

#[test]
fn calls_through_pointers_are_refused_in_every_disguise() {
    refused(
        "no-pointers",
        &[
            "let call: fn(u8) = later; call(1);",
            "const TABLE: [fn(u8); 2] = [first, second];",
            "static TABLE: [fn(u8); 2] = [first, second];",
            "type Handler = fn(u8);",
            "struct Handlers { first: fn(u8) }",
            "let call = first as fn(u8);",
            "let thing: &dyn Thing = other;",
            "fn take(thing: &dyn Thing) {}",
            "[first, second][0](2);",
            "(match at { 0 => first, _ => second })(1);",
        ],
    );
}

#[test]
fn circles_are_refused_in_every_disguise() {
    refused(
        "no-recursion-in-sources",
        &[
            "fn down(n: u8) -> u8 { down(n - 1) }",
            "fn down(n: u8) -> u8 { let again = |n| down(n - 1); again(n) }",
            "fn down(n: u8) -> u8 { write!(out, \"{}\", down(n - 1)) }",
            "fn even(n: u8) -> bool { odd(n - 1) } fn odd(n: u8) -> bool { even(n - 1) }",
            "fn a() { b() } fn b() { c() } fn c() { list.iter().for_each(a) }",
            "impl Thing { fn a(&self) { self.b() } fn b(&self) { Self::a(self) } }",
            "impl Thing { fn a(&self) { self.a() } }",
            "impl PartialEq for Thing { fn eq(&self, other: &Self) -> bool { *self == *other } }",
        ],
    );
    allowed(&["impl Add for Thing { fn add(self, other: Self) -> Self { Self { x: self.x + other.x } } }"]);
}
