//! The methods and functions that make, change or walk iterators.

/// Methods that walk their receiver to its end, or may.
pub const CONSUMERS: &[&str] = &[
    "for_each",
    "fold",
    "sum",
    "product",
    "count",
    "any",
    "all",
    "find",
    "find_map",
    "position",
    "rposition",
    "max_by",
    "min_by",
    "max_by_key",
    "min_by_key",
    "last",
    "collect",
    "extend",
    "try_fold",
    "try_for_each",
    "reduce",
    "partition",
    "eq",
    "ne",
    "lt",
    "cmp",
    "is_sorted",
    "rev",
    "copy_from_slice",
    "clone_from_slice",
    "fill",
    "fill_with",
    "extend_from_slice",
    "contains",
    "starts_with",
    "ends_with",
    "rotate_left",
    "rotate_right",
    "swap_with_slice",
    "retain",
    "retain_mut",
    "truncate",
    "resize",
    "resize_default",
    "clear",
    "binary_search_by",
    "binary_search_by_key",
    "partition_point",
    "map_while",
    "nth",
    "reverse",
    "checksum",
];

/// Methods that make an iterator of another: somebody else walks it, but the compiled loop may keep the place where it
/// was made.
pub const ADAPTERS: &[&str] = &[
    "filter",
    "filter_map",
    "flat_map",
    "flatten",
    "skip",
    "skip_while",
    "step_by",
    "take_while",
    "scan",
    "chain",
    "zip",
    "map",
];

/// Where endless iteration comes from.
pub const ENDLESS: &[&str] = &["repeat", "repeat_with", "cycle", "from_fn", "successors"];

/// Methods whose argument is a range of places, not something to walk.
pub const RANGE_TAKERS: &[&str] = &["get", "get_mut", "contains", "drain", "set_range"];
