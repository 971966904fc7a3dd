//! Writes the mutants of a file into it, each behind a branch that a switch chooses.
//!
//! Operands are evaluated once and named, so that branches may lie within branches without doubling the text.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};

use super::edits::{Edit, Order};
use super::list::{Genre, Mutant, Place};
use crate::copied_tree;

/// The module of the switch.
pub const MODULE: &str = "mutant_switch";

/// Where the switch lies.
fn switch() -> String {
    copied_tree::path_of(MODULE)
}

/// The edits for these mutants of one file, by their numbers. A mutant that no branch can express has none. What `constant`
/// functions say the compiler needs to know.
pub fn of_file(
    (text, syntax): (&str, &syn::File),
    mutants: &[(usize, &Mutant)],
    constant: &BTreeSet<String>,
) -> Vec<Edit> {
    let mut wanted = BTreeMap::<Place, Vec<(usize, &Mutant)>>::new();
    for (number, mutant) in mutants {
        wanted.entry(mutant.span.start).or_default().push((*number, mutant));
    }
    let mut visitor = Visitor { text, wanted, constant, depth: 0, edits: vec![] };
    visitor.visit_file(syntax);
    visitor.edits
}

struct Visitor<'a> {
    text: &'a str,
    wanted: BTreeMap<Place, Vec<(usize, &'a Mutant)>>,
    constant: &'a BTreeSet<String>,
    depth: usize,
    edits: Vec<Edit>,
}

fn on(number: usize) -> String {
    format!("{}::on({number})", switch())
}

/// `if on(1) { first } else if on(2) { second } else { otherwise }`.
fn choice(alternatives: impl Iterator<Item = (usize, String)>, otherwise: &str) -> String {
    let mut text = String::new();
    for (number, alternative) in alternatives {
        let _ = write!(text, "if {} {{ {alternative} }} else ", on(number));
    }
    text + "{ " + otherwise + " }"
}

impl Visitor<'_> {
    fn wanted_at(&self, syntax: &impl Spanned, genre: Genre) -> Vec<(usize, String)> {
        let here = self.wanted.get(&Place::of(syntax)).into_iter().flatten();
        here.filter(|(_, mutant)| mutant.genre == genre)
            .map(|(number, mutant)| (*number, mutant.replacement.clone()))
            .collect()
    }

    fn source(&self, syntax: &impl Spanned) -> &str {
        self.text.get(syntax.span().byte_range()).unwrap_or_default()
    }

    fn edit(&mut self, gone: std::ops::Range<usize>, order: Order, text: String, mutants: &[usize]) {
        self.edits.push(Edit { gone, text, order, mutants: mutants.to_vec() });
    }

    fn before(&mut self, syntax: &impl Spanned, text: impl Into<String>, mutants: &[usize]) {
        let at = syntax.span().byte_range().start;
        self.edit(at..at, Order::Opens(self.depth), text.into(), mutants);
    }

    fn instead(&mut self, syntax: &impl Spanned, text: impl Into<String>, mutants: &[usize]) {
        self.edit(syntax.span().byte_range(), Order::Opens(self.depth), text.into(), mutants);
    }

    fn behind(&mut self, syntax: &impl Spanned, text: impl Into<String>, mutants: &[usize]) {
        let at = syntax.span().byte_range().end;
        self.edit(at..at, Order::Closes(std::cmp::Reverse(self.depth)), text.into(), mutants);
    }

    fn function(&mut self, signature: &syn::Signature, block: &syn::Block) {
        if signature.constness.is_some() && self.constant.contains(&signature.ident.to_string()) {
            return;
        }
        let before = self.edits.len();
        let values = block.stmts.first().map(|first| self.wanted_at(first, Genre::FnValue));
        let at = block.brace_token.span.open().byte_range().end;
        for (number, value) in values.unwrap_or_default() {
            let text = format!(" if {} {{ return {value}; }}", on(number));
            self.edit(at..at, Order::Opens(self.depth), text, &[number]);
        }
        self.visit_block(block);
        // A switch is asked when the code runs.
        if let Some(word) = signature.constness.filter(|_| self.edits.len() > before) {
            self.instead(&word, "", &[]);
        }
    }

    /// An operator whose operands are both evaluated.
    fn operator(&mut self, binary: &syn::ExprBinary, alternatives: Vec<(usize, String)>) {
        let numbers: Vec<usize> = alternatives.iter().map(|(number, _)| *number).collect();
        use syn::BinOp::{Eq, Ge, Gt, Le, Lt, Ne};
        let borrowed =
            if matches!(binary.op, Eq(_) | Ne(_) | Lt(_) | Le(_) | Gt(_) | Ge(_)) { "&" } else { "" };
        let otherwise = format!("l {} r", self.source(&binary.op));
        let alternatives =
            choice(alternatives.into_iter().map(|(number, op)| (number, format!("l {op} r"))), &otherwise);
        self.before(&binary.left, format!("(match ({borrowed}("), &numbers);
        self.instead(&binary.op, format!("), {borrowed}("), &numbers);
        self.behind(&binary.right, format!(")) {{ (l, r) => {alternatives} }})"), &numbers);
    }

    /// `&&` and `||`, which become each other: the right side is evaluated only if the left one asks for it.
    fn lazy(&mut self, binary: &syn::ExprBinary, number: usize) {
        let is_and = matches!(binary.op, syn::BinOp::And(_));
        let (alternative, result) = if is_and { ("and", "") } else { ("or", "!") };
        self.before(&binary.left, format!("(if {}::{alternative}({number}, (", switch()), &[number]);
        self.instead(&binary.op, ")) { ", &[number]);
        self.behind(&binary.right, format!(" }} else {{ {result}{} }})", on(number)), &[number]);
    }

    /// `a += b`.
    fn assignment(&mut self, binary: &syn::ExprBinary, alternatives: Vec<(usize, String)>) {
        let numbers: Vec<usize> = alternatives.iter().map(|(number, _)| *number).collect();
        let place = self.source(&binary.left).to_owned();
        let otherwise = format!("{place} {} r", self.source(&binary.op));
        let alternatives = choice(
            alternatives.into_iter().map(|(number, op)| (number, format!("{place} {op} r"))),
            &otherwise,
        );
        let gone = binary.left.span().byte_range().start..binary.right.span().byte_range().start;
        self.edit(gone, Order::Opens(self.depth), String::from("match ("), &numbers);
        self.behind(&binary.right, format!(") {{ r => {alternatives} }}"), &numbers);
    }

    /// The parts of a chain of conditions with a `let` in it, whose `&&` nothing can take the place of.
    fn chain_with_let(&mut self, expression: &syn::Expr) {
        match expression {
            syn::Expr::Binary(binary) if matches!(binary.op, syn::BinOp::And(_)) => {
                self.chain_with_let(&binary.left);
                self.chain_with_let(&binary.right);
            }
            other => self.visit_expr(other),
        }
    }

    fn guard(&mut self, guard: &syn::Expr, without: Option<usize>) {
        let alternatives = self.wanted_at(guard, Genre::MatchArmGuard);
        let becomes = |word: &str| {
            alternatives.iter().find(|(_, alternative)| alternative == word).map(|(number, _)| *number)
        };
        let (always, never) = (becomes("true"), becomes("false"));
        let numbers: Vec<usize> = [without, always, never].into_iter().flatten().collect();
        if numbers.is_empty() {
            return;
        }
        let asked = |number: Option<usize>| number.map_or_else(|| String::from("false"), on);
        let head = format!("(!{} && ({} || (!{} && (", asked(without), asked(always), asked(never));
        self.before(guard, head, &numbers);
        self.behind(guard, "))))", &numbers);
    }
}

fn holds_let(expression: &syn::Expr) -> bool {
    match expression {
        syn::Expr::Let(_) => true,
        syn::Expr::Binary(binary) if matches!(binary.op, syn::BinOp::And(_)) => {
            holds_let(&binary.left) || holds_let(&binary.right)
        }
        _ => false,
    }
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.function(&function.sig, &function.block);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.function(&function.sig, &function.block);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(block) = &function.default {
            self.function(&function.sig, block);
        }
    }

    // What the compiler evaluates asks no switch.
    fn visit_item_const(&mut self, _: &'ast syn::ItemConst) {}
    fn visit_item_static(&mut self, _: &'ast syn::ItemStatic) {}
    fn visit_impl_item_const(&mut self, _: &'ast syn::ImplItemConst) {}
    fn visit_trait_item_const(&mut self, _: &'ast syn::TraitItemConst) {}
    fn visit_expr_const(&mut self, _: &'ast syn::ExprConst) {}
    fn visit_type(&mut self, _: &'ast syn::Type) {}
    fn visit_pat(&mut self, _: &'ast syn::Pat) {}
    fn visit_generic_argument(&mut self, _: &'ast syn::GenericArgument) {}

    fn visit_expr_repeat(&mut self, array: &'ast syn::ExprRepeat) {
        self.visit_expr(&array.expr);
    }

    fn visit_expr(&mut self, expression: &'ast syn::Expr) {
        self.depth += 1;
        visit::visit_expr(self, expression);
        self.depth -= 1;
    }

    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        use syn::BinOp::{And, Or};
        let alternatives = self.wanted_at(&binary.op, Genre::BinaryOperator);
        let whole = syn::Expr::Binary(binary.clone());
        match (&binary.op, alternatives.first()) {
            (And(_), _) if holds_let(&whole) => return self.chain_with_let(&whole),
            (_, None) => {}
            (And(_) | Or(_), Some((number, _))) if alternatives.len() == 1 => self.lazy(binary, *number),
            (And(_) | Or(_), Some(_)) => {}
            _ if self.source(&binary.op).ends_with('=') && is_assignment(&binary.op) => {
                self.assignment(binary, alternatives);
            }
            _ => self.operator(binary, alternatives),
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        if let Some((number, _)) = self.wanted_at(&unary.op, Genre::UnaryOperator).first() {
            let alternatives = choice(
                [(*number, String::from("v"))].into_iter(),
                &(self.source(&unary.op).to_owned() + "v"),
            );
            self.instead(&unary.op, "(match (", &[*number]);
            self.behind(&unary.expr, format!(") {{ v => {alternatives} }})"), &[*number]);
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        let without = self.wanted_at(&arm.pat, Genre::MatchArm).first().map(|(number, _)| *number);
        match (&arm.pat, without) {
            (syn::Pat::Guard(guarded), without) => {
                self.guard(&guarded.guard, without);
                self.visit_expr(&guarded.guard);
            }
            (pattern, Some(number)) => self.behind(pattern, format!(" if !{}", on(number)), &[number]),
            (_, None) => {}
        }
        self.visit_expr(&arm.body);
    }

    fn visit_expr_struct(&mut self, value: &'ast syn::ExprStruct) {
        let rest = value.rest.as_ref().map(|rest| self.source(rest).to_owned());
        for field in value.fields.iter().filter(|field| field.colon_token.is_some()) {
            let gone = self.wanted_at(field, Genre::StructField);
            if let (Some(rest), Some((number, _))) = (&rest, gone.first()) {
                let name = self.source(&field.member).to_owned();
                self.before(
                    &field.expr,
                    format!("(if {} {{ ({rest}).{name} }} else {{ ", on(*number)),
                    &[*number],
                );
                self.behind(&field.expr, " })", &[*number]);
            }
        }
        visit::visit_expr_struct(self, value);
    }
}

fn is_assignment(operator: &syn::BinOp) -> bool {
    use syn::BinOp;
    matches!(
        operator,
        BinOp::AddAssign(_)
            | BinOp::SubAssign(_)
            | BinOp::MulAssign(_)
            | BinOp::DivAssign(_)
            | BinOp::RemAssign(_)
            | BinOp::BitXorAssign(_)
            | BinOp::BitAndAssign(_)
            | BinOp::BitOrAssign(_)
            | BinOp::ShlAssign(_)
            | BinOp::ShrAssign(_)
    )
}

#[cfg(test)]
mod tests {
    use super::super::edits;
    use super::super::list::Span;
    use super::*;

    /// The text with these changes: genre, line, column, replacement.
    fn mutated(text: &str, changes: &[(Genre, usize, usize, &str)]) -> String {
        let mutants: Vec<Mutant> = changes
            .iter()
            .map(|(genre, line, column, replacement)| {
                let start = Place { line: *line, column: *column };
                let (name, file) = (String::new(), String::new());
                let span = Span { start, end: start };
                Mutant { name, file, genre: *genre, replacement: (*replacement).to_owned(), span }
            })
            .collect();
        let numbered: Vec<(usize, &Mutant)> = mutants.iter().enumerate().collect();
        let syntax = syn::parse_file(text).expect("the example parses");
        let edits = of_file((text, &syntax), &numbered, &BTreeSet::new());
        let text = edits::apply(text, edits).text.replace(&(switch() + "::"), "");
        syn::parse_file(&text).expect("the mutated example parses");
        text
    }

    #[test]
    fn operators_evaluate_their_operands_once() {
        assert_eq!(
            mutated("fn f() -> u8 { a + b }", &[(Genre::BinaryOperator, 1, 18, "-")]),
            "fn f() -> u8 { (match ((a ), ( b)) { (l, r) => if on(0) { l - r } else { l + r } }) }"
                .replace("a )", "a ")
                .replace("a , ", "a ), ")
        );
    }

    #[test]
    fn branches_lie_within_branches() {
        let text = mutated(
            "fn f() -> bool { a < b && !c }",
            &[
                (Genre::BinaryOperator, 1, 20, "<="),
                (Genre::BinaryOperator, 1, 24, "||"),
                (Genre::UnaryOperator, 1, 27, ""),
            ],
        );
        assert!(text.contains("(if and(1, ((match (&(a ), &( b)) { (l, r) => if on(0) { l <= r }"), "{text}");
        assert!(
            text.contains("{  (match (c) { v => if on(2) { v } else { !v } }) } else { on(1) }"),
            "{text}"
        );
    }

    #[test]
    fn constants_and_let_chains_are_not_switched() {
        let constant = "const A: u8 = 1 + 2;";
        assert_eq!(mutated(constant, &[(Genre::BinaryOperator, 1, 17, "-")]), constant);
        let chain = "fn f() { if a && let Some(b) = c {} }";
        assert_eq!(mutated(chain, &[(Genre::BinaryOperator, 1, 15, "||")]), chain);
    }

    #[test]
    fn arms_values_fields_and_assignments() {
        let arm = mutated(
            "fn f() { match x { 1 => a, 2 if g => b, _ => c } }",
            &[(Genre::MatchArm, 1, 20, ""), (Genre::MatchArmGuard, 1, 33, "true")],
        );
        assert!(arm.contains("1 if !on(0) => a, 2 if (!false && (on(1) || (!false && (g)))) => b"), "{arm}");
        let value = mutated("const fn f() -> u8 { a }", &[(Genre::FnValue, 1, 22, "0")]);
        assert_eq!(value, " fn f() -> u8 { if on(0) { return 0; } a }");
        assert_eq!(mutated("const fn f() -> u8 { a }", &[]), "const fn f() -> u8 { a }");
        let field = mutated("fn f() { S { a: 1, ..t } }", &[(Genre::StructField, 1, 14, "")]);
        assert!(field.contains("S { a: (if on(0) { (t).a } else { 1 }), ..t }"), "{field}");
        let assignment = mutated("fn f() { a.b += 1; }", &[(Genre::BinaryOperator, 1, 14, "-=")]);
        assert!(
            assignment.contains("match (1) { r => if on(0) { a.b -= r } else { a.b += r } };"),
            "{assignment}"
        );
    }
}
