//! The parts of the code that are spoiled, and the tests that watch over them.

/// A part of the code.
pub struct Part {
    /// Name of the campaign.
    pub name: &'static str,
    /// Package that is spoiled.
    pub package: &'static str,
    /// Files to spoil.
    pub files: &'static [&'static str],
    /// Tests, the quick ones first: a later suite sees what survived the earlier ones.
    pub suites: &'static [Suite],
    /// Share of viable mutants that must be caught or explained, per cent.
    pub wanted_percent: f64,
}

/// Some tests in one program.
pub struct Suite {
    /// Package of the tests.
    pub package: &'static str,
    /// `--lib`, or `--test` with the name of the file.
    pub target: &'static [&'static str],
    /// Words that choose tests; none: all of them.
    pub chosen: &'static [&'static str],
    /// Words of tests that are left out.
    pub skipped: &'static [&'static str],
}

/// All parts.
pub const PARTS: &[Part] = &[
    Part {
        name: "mutants-guard",
        package: "floorguard-core",
        files: &["core-nostd/src/guard/**", "core-nostd/src/protection/**"],
        suites: &[
            Suite {
                package: "floorguard-core",
                target: &["--lib"],
                chosen: &["guard", "protection"],
                skipped: &["reachable", "bit_flips"],
            },
            Suite {
                package: "floorguard-core",
                target: &["--lib"],
                chosen: &["reachable", "bit_flips"],
                skipped: &[],
            },
        ],
        wanted_percent: 100.0,
    },
    Part {
        name: "mutants-drivers",
        package: "floorguard-drivers",
        files: &["drivers/src/**"],
        suites: &[Suite { package: "floorguard-drivers", target: &["--lib"], chosen: &[], skipped: &[] }],
        wanted_percent: 85.0,
    },
];
