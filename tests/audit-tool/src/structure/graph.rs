//! Dependencies by name: cycles, order, and what is left when implied arrows go.

use std::collections::{BTreeMap, BTreeSet};

/// Arrows from each name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Graph {
    arrows: BTreeMap<String, BTreeSet<String>>,
}

impl Graph {
    /// A name, with or without arrows.
    pub fn add(&mut self, name: &str) {
        self.arrows.entry(name.to_owned()).or_default();
    }

    /// An arrow; one to itself says nothing.
    pub fn point(&mut self, from: &str, to: &str) {
        self.add(from);
        self.add(to);
        if from != to {
            self.arrows.entry(from.to_owned()).or_default().insert(to.to_owned());
        }
    }

    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.arrows.keys().map(String::as_str)
    }

    /// Where the arrows of a name lead.
    pub fn of(&self, name: &str) -> impl Iterator<Item = &str> {
        self.arrows.get(name).into_iter().flatten().map(String::as_str)
    }

    /// Everything that can be reached from a name by at least one arrow.
    fn reached(&self, start: &str) -> BTreeSet<&str> {
        let mut reached = BTreeSet::new();
        let mut open: Vec<&str> = self.of(start).collect();
        while let Some(name) = open.pop() {
            if reached.insert(name) {
                open.extend(self.of(name));
            }
        }
        reached
    }

    /// Groups of names that reach one another.
    pub fn cycles(&self) -> Vec<BTreeSet<String>> {
        let reached: BTreeMap<&str, BTreeSet<&str>> =
            self.names().map(|name| (name, self.reached(name))).collect();
        let mut cycles = BTreeSet::new();
        for (name, others) in reached.iter().filter(|(name, others)| others.contains(*name)) {
            let group = others.iter().filter(|other| reached[**other].contains(name));
            cycles.insert(group.map(|other| (*other).to_owned()).collect::<BTreeSet<_>>());
        }
        cycles.into_iter().collect()
    }

    /// Names in an order in which each comes before those that it points to; within a cycle by the alphabet.
    pub fn ordered(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.names().collect();
        names.sort_by_cached_key(|name| (std::cmp::Reverse(self.reached(name).len()), *name));
        names
    }

    /// Without the arrows that others imply.
    pub fn reduced(&self) -> Self {
        let mut reduced = Self::default();
        for from in self.names() {
            reduced.add(from);
            let implied = |to: &str| self.of(from).any(|over| over != to && self.reached(over).contains(to));
            for to in self.of(from).filter(|to| !implied(to)) {
                reduced.point(from, to);
            }
        }
        reduced
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(arrows: &[(&str, &str)]) -> Graph {
        let mut graph = Graph::default();
        arrows.iter().for_each(|(from, to)| graph.point(from, to));
        graph
    }

    #[test]
    fn cycles_are_groups_that_reach_one_another() {
        assert!(graph(&[("a", "b"), ("b", "c"), ("a", "c"), ("a", "a")]).cycles().is_empty());
        let two = graph(&[("a", "b"), ("b", "a"), ("b", "c"), ("c", "d"), ("d", "e"), ("e", "c")]);
        let groups: Vec<Vec<String>> =
            two.cycles().into_iter().map(|group| group.into_iter().collect()).collect();
        assert_eq!(groups, [vec!["a", "b"], vec!["c", "d", "e"]]);
    }

    #[test]
    fn users_come_first_and_implied_arrows_go() {
        let chain = graph(&[("app", "core"), ("app", "types"), ("core", "types")]);
        assert_eq!(chain.ordered(), ["app", "core", "types"]);
        assert_eq!(chain.reduced(), graph(&[("app", "core"), ("core", "types")]));
    }
}
