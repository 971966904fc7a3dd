//! What a `use` names.

/// Every path of a `use`.
pub fn paths_of(tree: &syn::UseTree) -> Vec<Vec<String>> {
    match tree {
        syn::UseTree::Path(path) => {
            let below = paths_of(&path.tree).into_iter();
            below.map(|rest| [vec![path.ident.to_string()], rest].concat()).collect()
        }
        syn::UseTree::Name(name) => vec![vec![name.ident.to_string()]],
        syn::UseTree::Rename(name) => vec![vec![name.ident.to_string()]],
        syn::UseTree::Glob(_) => vec![vec![String::from("*")]],
        syn::UseTree::Group(group) => group.items.iter().flat_map(paths_of).collect(),
    }
}
