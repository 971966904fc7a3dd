//! Each kind of mistake makes the audit fail and names its line.

use crate::claim::Finding;
use crate::forbidden::{Forbidden, circles};
use crate::{forbidden, loops, sources};

fn loops_of(text: &str) -> (usize, Vec<Finding>) {
    let file =
        sources::parse("core-nostd/guard/src/example.rs", text.to_owned()).expect("the example parses");
    let (sites, findings) = loops::list(&file);
    (sites.len(), findings)
}

fn forbidden_in(text: &str) -> Forbidden {
    let file =
        sources::parse("core-nostd/guard/src/example.rs", text.to_owned()).expect("the example parses");
    let mut found = Forbidden::default();
    forbidden::inspect(&file, &mut found);
    found
}

fn names_line(findings: &[Finding], line: usize) {
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!((findings[0].place.as_str(), findings[0].line), ("core-nostd/guard/src/example.rs", line));
}

#[test]
fn bounded_loops_pass() {
    let text = "fn f(a: &[u8; 4], n: usize) -> u32 {\n for i in 0..CAPACITY {}\n for i in 0..n.min(CAPACITY) {}\n \
                for x in a {}\n a.iter().map(|x| u32::from(*x)).sum()\n}";
    let (sites, findings) = loops_of(text);
    assert_eq!((sites, findings), (4, vec![]));
}

#[test]
fn a_loop_without_its_bound_is_refused() {
    names_line(&loops_of("fn f(n: usize) {\n\n for i in 0..n {}\n}").1, 3);
    names_line(&loops_of("fn f() {\n for i in 3.. {}\n}").1, 2);
    names_line(&loops_of("fn f() -> u8 {\n core::iter::repeat(1).sum()\n}").1, 2);
    assert!(loops_of("fn f() -> u8 { core::iter::repeat(1).take(SIZE).sum() }").1.is_empty());
}

#[test]
fn bound_is_followed_to_its_let_only() {
    assert!(loops_of("fn f(n: usize) { let last = n.min(CAPACITY); for i in 0..last / 2 {} }").1.is_empty());
    assert!(loops_of("fn f(n: u8) { for i in 0..n {} }").1.is_empty());
    names_line(&loops_of("fn f(n: usize) {\n let last = n;\n for i in 0..last {}\n}").1, 3);
    names_line(&loops_of("fn f(n: usize) {\n let mut m = 3;\n m = n;\n for i in 0..m {}\n}").1, 4);
    names_line(&loops_of("fn f(n: usize) {\n let m = 3;\n g(|m| {\n for i in 0..m {}\n })\n}").1, 4);
    names_line(&loops_of("fn f(n: usize) {\n for i in 0..CAPACITY - n {}\n}").1, 2);
    names_line(&loops_of("fn f(n: usize) {\n for i in 0..u64::MAX {}\n}").1, 2);
}

#[test]
fn endless_range_is_refused_at_its_origin() {
    names_line(&loops_of("fn f() -> impl Iterator {\n (0..).map(g)\n}").1, 2);
    assert!(loops_of("fn f(a: &[u8]) { for x in (0..).step_by(2).zip(a) {} }").1.is_empty());
    assert!(loops_of("fn f(n: usize) -> bool { (1..n).contains(&3) }").1.is_empty());
}

#[test]
fn waiting_for_a_sensor_is_refused_outside_async() {
    names_line(&loops_of("fn f(s: &S) {\n while s.ready() {}\n}").1, 2);
    names_line(&loops_of("async fn f(s: &S) {\n loop { s.read(); }\n}").1, 2);
    assert!(loops_of("async fn f(s: &S) { loop { s.read().await; } }").1.is_empty());
}

#[test]
fn the_heap_is_refused() {
    names_line(&forbidden_in("use alloc::vec;\n").heap, 1);
    names_line(&forbidden_in("\nfn f() { let v: Vec<u8> = x; }").heap, 2);
    assert!(forbidden_in("use heapless::Vec;\nfn f() { let v: Vec<u8, 4> = x; }").heap.is_empty());
}

#[test]
fn panics_are_refused() {
    names_line(&forbidden_in("fn f(x: Option<u8>) -> u8 {\n x.unwrap()\n}").panics, 2);
    names_line(&forbidden_in("fn f() {\n\n panic!(\"no\")\n}").panics, 3);
    assert!(forbidden_in("#[cfg(test)]\nmod tests { fn f() { x.unwrap(); } }").panics.is_empty());
}

#[test]
fn recursion_unsafe_code_and_pointers_are_refused() {
    names_line(&forbidden_in("fn f(n: u8) -> u8 {\n f(n - 1)\n}").recursion, 2);
    names_line(&forbidden_in("impl T {\nfn f(&self) {\n self.f()\n}}").recursion, 3);
    names_line(&forbidden_in("impl T {\nfn f(&self) {\n T::f(self)\n}}").recursion, 3);
    // A method that calls the free function of its name, and the other way round, go round no circle.
    assert!(forbidden_in("impl T { fn f(&self) { f() } }").recursion.is_empty());
    assert!(forbidden_in("fn f(t: &T) { t.f(); T::f(t) }").recursion.is_empty());
    names_line(&forbidden_in("fn f() {\n unsafe { g() }\n}").unsafe_code, 2);
    names_line(&forbidden_in("struct S {\n call: fn(u8) -> u8,\n}").pointers, 2);
    names_line(&forbidden_in("fn f(\n x: &dyn T) {}").pointers, 2);
}

#[test]
fn cycles_over_several_functions_are_found() {
    let graph = [("a", vec!["b"]), ("b", vec!["c"]), ("c", vec!["a"]), ("d", vec!["a"])]
        .into_iter()
        .map(|(caller, callees)| (caller.to_owned(), callees.into_iter().map(str::to_owned).collect()))
        .collect();
    assert_eq!(circles::cycles(&graph), [["a", "b", "c"].map(str::to_owned).to_vec()]);
}

#[test]
fn a_bound_counts_every_turn() {
    let bound = |text: &str| {
        let file =
            sources::parse("core-nostd/guard/src/example.rs", text.to_owned()).expect("the example parses");
        loops::list(&file).0.first().map(|site| site.bound.clone()).unwrap_or_default()
    };
    assert_eq!(bound("fn f() { for i in 0..N {} }"), "N");
    assert_eq!(bound("fn f() { for i in 0..=N {} }"), "N + 1");
    assert_eq!(bound("fn f() { for i in -REACH..=REACH {} }"), "REACH + REACH + 1");
    assert_eq!(bound("fn f() { for x in a.iter().chain(&b) {} }"), "capacity of `a` + that of `b`");
}
