//! Names that must not stand in the audited layers.

/// Methods that panic by design.
pub const PANICKING_METHODS: &[&str] = &["unwrap", "expect", "unwrap_err", "expect_err"];
/// Macros that panic by design.
pub const PANICKING_MACROS: &[&str] =
    &["panic", "unreachable", "todo", "unimplemented", "assert", "assert_eq", "assert_ne"];
/// Methods of slices that panic where lengths do not fit, and have a sibling that does not.
pub const PANICKING_SLICES: &[&str] =
    &["copy_from_slice", "clone_from_slice", "copy_within", "swap_with_slice", "select_nth_unstable"];
/// What needs an allocator, and the crates that bring one.
pub const HEAP_NAMES: &[&str] = &[
    "alloc",
    "std",
    "Box",
    "String",
    "Rc",
    "Arc",
    "BTreeMap",
    "BTreeSet",
    "HashMap",
    "HashSet",
    "VecDeque",
    "LinkedList",
    "BinaryHeap",
];
/// Macros that write machine code.
pub const ASSEMBLING_MACROS: &[&str] = &["asm", "global_asm", "naked_asm"];
/// Attributes that promise the linker something which nobody checks.
pub const UNSAFE_ATTRIBUTES: &[&str] = &["no_mangle", "export_name", "link_section"];
/// Operators and the methods that they call.
pub const OPERATORS: &[(&str, &str)] = &[
    ("==", "eq"),
    ("!=", "ne"),
    ("<", "lt"),
    ("<=", "le"),
    (">", "gt"),
    (">=", "ge"),
    ("+", "add"),
    ("-", "sub"),
    ("*", "mul"),
    ("/", "div"),
    ("%", "rem"),
    ("+=", "add_assign"),
    ("-=", "sub_assign"),
    ("*=", "mul_assign"),
    ("/=", "div_assign"),
    ("&", "bitand"),
    ("|", "bitor"),
    ("^", "bitxor"),
    ("<<", "shl"),
    (">>", "shr"),
];
