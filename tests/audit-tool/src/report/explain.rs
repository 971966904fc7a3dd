//! What a doubting reader asks of each claim: how it is checked, what the check cannot see, and how to watch it fail.

/// The answers for one claim.
pub struct Explanation {
    /// The claim.
    pub id: &'static str,
    /// How it is checked.
    pub how: &'static str,
    /// What the check does not show.
    pub limit: &'static str,
    /// Section of the page that holds the evidence.
    pub anchor: &'static str,
    /// Test that makes the claim fail on purpose.
    pub broken_by: &'static str,
}

const fn explanation(
    id: &'static str,
    (how, limit): (&'static str, &'static str),
    (anchor, broken_by): (&'static str, &'static str),
) -> Explanation {
    Explanation { id, how, limit, anchor, broken_by }
}

const SOURCES: &str =
    "Syntax without types; the linked image is asked the same question by the claims below.";

/// One for each claim.
pub const EXPLANATIONS: &[Explanation] = &[
    explanation(
        "loops-bounded",
        (
            "Each loop and iterator chain must end in a constant, a capacity, or the largest value of a small type. Endless \
             sources, ranges kept in names, loops in macros and iterators of our own are refused where they are made.",
            "Syntax without types: that a name holds a container is concluded from refusing everything else. See \
             loops-complete and loops-within-bounds for the other two sides.",
        ),
        ("loops", "sneaky_tests.rs: loops_*"),
    ),
    explanation(
        "no-unsafe",
        (
            "No unsafe block, function, trait, implementation, changing static, foreign function, assembly or linker \
             attribute, in macros neither; both crates must begin with forbid(unsafe_code).",
            "The libraries below contain unsafe code of their own.",
        ),
        ("dependencies", "sneaky_tests.rs: unsafe_code_*"),
    ),
    explanation(
        "no-heap-in-sources",
        ("No name that allocates, and no_std at the head of both crates.", SOURCES),
        ("claims", "sneaky_tests.rs: the_heap_*"),
    ),
    explanation(
        "no-panic-in-sources",
        (
            "No unwrap, expect, panicking macro, index that is computed, or copy between slices of unequal length, in macros \
             neither.",
            SOURCES,
        ),
        ("claims", "sneaky_tests.rs: panics_*"),
    ),
    explanation(
        "no-pointers",
        ("No function pointer and no trait object, in constants and macros neither.", SOURCES),
        ("claims", "sneaky_tests.rs: calls_through_pointers_*"),
    ),
    explanation(
        "no-recursion-in-sources",
        (
            "No function that calls itself, by an operator neither, and no circle of functions of a file or a type.",
            "Circles through traits or over several crates are seen in the image only.",
        ),
        ("claims", "sneaky_tests.rs: circles_*"),
    ),
    explanation(
        "tasks-in-sources",
        (
            "The same searches for the heap, panics, unsafe code and loops in the tasks that make drive commands of decisions, \
             and in what they share; a loop without an end must wait for something in every turn.",
            "Sources only: their executor calls through registers, and libraries wait for them. No claim on circles, \
             pointers and their stack.",
        ),
        ("claims", "tasks.rs: mistake_in_a_task_is_named"),
    ),
    explanation(
        "loops-within-bounds",
        (
            "A copy of the tree counted the turns of its loops while the tests ran; no recorded count may exceed its bound, and \
             there must be a record.",
            "Recorded, not repeated here. A loop that no test reached has no count: the table says which, and why.",
        ),
        ("loops", "seen.rs: a_count_above_its_bound_is_named"),
    ),
    explanation(
        "hosted-only-apart",
        (
            "The sources of core, drivers, runtime and both boards are searched for the names of these modules.",
            "What these do on the Linux computer is judged from their sources only: not linked for the Cortex-M7, so no \
             proof against panics or for their stack. If one panics, the program ends, and the drives stop by their own \
             heartbeat watch (assumption A4).",
        ),
        ("hosted", "hosted_only.rs: a_hosted_module_in_an_image_is_named"),
    ),
    explanation(
        "image-builds",
        (
            "The roots of tests/safety-image call every stage, and are linked as the firmware is.",
            "One compiler, one target.",
        ),
        ("stack", "any mistake that does not compile"),
    ),
    explanation(
        "no-heap-linked",
        (
            "No symbol of an allocator in the image, and no instruction that came from the library of the heap, inlined or not; \
             its line is named.",
            "The image of the audit, not the firmware with its board support.",
        ),
        ("stack", "image_injection_tests.rs: inlined_heap_use_is_named"),
    ),
    explanation(
        "no-panic-linked",
        (
            "No call of a panicking function of the standard library is left after optimisation; where one is, the line is \
             named from the debug information.",
            "Overflow of integers wraps in this build; clippy and the saturating style answer that.",
        ),
        ("stack", "image_injection_tests.rs: a_panic_that_the_optimiser_leaves_is_named"),
    ),
    explanation(
        "no-recursion-linked",
        (
            "The call graph of the disassembly has no cycle, and no function calls its own beginning.",
            "Direct calls; indirect ones are the next claim.",
        ),
        ("stack", "image_injection_tests.rs: recursion_is_named, a_circle_of_two_functions_is_named"),
    ),
    explanation(
        "no-indirect-calls-linked",
        (
            "No call or jump through a register but returns and jump tables.",
            "Which entry of a jump table is taken is not followed: all of them are in the same function.",
        ),
        ("stack", "image_injection_tests.rs: a_call_through_a_register_is_named"),
    ),
    explanation(
        "modules-linked",
        (
            "Every module of core and drivers has code in the image, but for those that run on Linux only.",
            "A module counts as linked when some of its code is.",
        ),
        ("hosted", "leave a root out of tests/safety-image"),
    ),
    explanation(
        "roots-linked",
        (
            "Each function root_… of tests/safety-image is a function of the linked image: what it is given is hidden from the \
             compiler, which would leave out what it can foresee.",
            "That a root reaches all of its stage is for its reader to judge; the counts of functions and loops are in the table.",
        ),
        ("stack", "image_claims.rs: optimised_away_root_is_named"),
    ),
    explanation(
        "loops-complete",
        (
            "Each backward branch of the image is led back, over inlined calls, to a line of the list.",
            "Loops of libraries are counted, not listed one by one.",
        ),
        ("loops", "image_injection_tests.rs: loop_waiting_for_a_sensor_is_named, a_clean_image_passes_and_…"),
    ),
    explanation(
        "stack-budget",
        (
            "Frames from the disassembly along the deepest chain of calls; a frame that moves at run time fails.",
            "Interrupts and the executor come on top: the firmware measures them.",
        ),
        ("stack", "image_injection_tests.rs: a_frame_over_budget_is_named"),
    ),
    explanation(
        "requirements-traced",
        (
            "Each requirement names code and tests, found by their marks; the tests ran just now.",
            "That a test tests what its requirement says is for the reader to judge: both are one click away.",
        ),
        ("requirements", "trace.rs"),
    ),
    explanation(
        "hazards-answered",
        (
            "Each hazard has causes of the guard and requirements; each cause and requirement has a hazard.",
            "The list of hazards is the authors': no hazard analysis of a machine.",
        ),
        ("hazards", "trace.rs"),
    ),
    explanation(
        "dependencies-known",
        (
            "cargo tree of the image; each crate needs a reason and a licence that is allowed.",
            "The crates themselves were not audited.",
        ),
        ("dependencies", "dependencies.rs"),
    ),
    explanation(
        "states-pictured",
        (
            "The search over all reachable states of the decision machine printed these transitions just now, and the table of \
             causes each cause of the code, of each source where it has one; a state that the picture does not know fails.",
            "Exhaustive for its abstraction: twelve happenings, steps of 200 ms, one set of fields.",
        ),
        ("states", "picture.rs: a_state_that_is_not_drawn_is_named, causes_that_are_not_printed_are_named"),
    ),
    explanation(
        "mutants-caught",
        (
            "The recorded run: of the guard every mutant is caught or has a reason why nobody can notice it; of the drivers 85 %. \
             What was not tried counts as not caught; a part without a record fails.",
            "Recorded, not repeated here; it knows the mistakes that cargo-mutants knows, and the package's own tests.",
        ),
        ("mutants", "mutation.rs: a_record_below_its_share_fails, a_part_without_a_record_fails"),
    ),
    explanation(
        "crates-layered",
        (
            "Cargo's metadata against the column `may depend on` of the architecture's tables: each arrow needs a row, and no \
             cycle may come of them.",
            "Dependencies of tests alone are left out. What broke the rule when it was made is in tests/structure-known.toml.",
        ),
        ("claims", "planted_tests.rs: disallowed_arrow_is_refused"),
    ),
    explanation(
        "modules-acyclic",
        (
            "Every `use` and every path of a crate, led to the top module that it names; what the root hands on counts as its \
             module's.",
            "Calls of methods name no module and are not seen.",
        ),
        ("claims", "planted_tests.rs: module_cycle_is_found_in_any_notation"),
    ),
    explanation(
        "files-short",
        (
            "Lines of each file and of each top module, tests included.",
            "Length says nothing of what the lines hold.",
        ),
        ("claims", "planted_tests.rs: each_planted_fault_turns_its_claim"),
    ),
    explanation(
        "structure-drawn",
        ("The drawn graph is compared with the one read just now.", "As crates-layered and modules-acyclic."),
        ("claims", "planted_tests.rs: each_planted_fault_turns_its_claim"),
    ),
];

/// The answers for a claim.
pub fn of(id: &str) -> Option<&'static Explanation> {
    EXPLANATIONS.iter().find(|explanation| explanation.id == id)
}
