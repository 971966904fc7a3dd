//! Crowds to follow: how many, where they walk, what hides them, and whether the robot drives.

use std::fmt::Write as _;

use anyhow::Context as _;
use floorguard_sim::Scenario;
use floorguard_types::random::Pcg32;

/// A kind of crowd.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CrowdScene {
    /// For the table.
    pub name: &'static str,
    /// How many.
    pub people: u32,
    /// Where they walk.
    pub pattern: WalkPattern,
    /// Columns and a partition stand in the hall.
    pub columns: bool,
    /// The robot drives a circle of about 3 m instead of standing.
    pub drives: bool,
    /// Everybody has a body and clothes of their own, instead of all adults the same.
    pub varied: bool,
}

/// Where people walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WalkPattern {
    /// From anywhere to anywhere; one in eight stands.
    Milling,
    /// Two streams cross in front of the robot.
    Crossing,
}

/// The crowds of the crowd benchmark.
pub const CROWDS: [CrowdScene; 7] = [
    CrowdScene {
        name: "5 milling",
        people: 5,
        pattern: WalkPattern::Milling,
        columns: false,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "15 milling",
        people: 15,
        pattern: WalkPattern::Milling,
        columns: false,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "15 crossing",
        people: 15,
        pattern: WalkPattern::Crossing,
        columns: false,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "15 among columns",
        people: 15,
        pattern: WalkPattern::Milling,
        columns: true,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "30 milling",
        people: 30,
        pattern: WalkPattern::Milling,
        columns: false,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "30 crossing",
        people: 30,
        pattern: WalkPattern::Crossing,
        columns: false,
        drives: false,
        varied: false,
    },
    CrowdScene {
        name: "30, robot drives",
        people: 30,
        pattern: WalkPattern::Milling,
        columns: false,
        drives: true,
        varied: false,
    },
];

/// Half the hall, metres: its corners are 12 m from the middle.
const HALF_M: [f32; 2] = [9.6, 7.2];
/// Places nearer to a wall than this are not walked to, metres.
const MARGIN_M: f32 = 0.8;
/// Where the robot begins; it turns about a point 3 m to its left.
const START_M: [f32; 2] = [0.0, -3.0];
/// Nobody begins nearer to the robot than this, metres.
const CLEAR_M: f32 = 1.6;

impl CrowdScene {
    /// Written as scenario text, so that it can be examined with `floorguard simulate`.
    #[must_use]
    pub fn text(&self, seed: u64) -> String {
        let mut random = Pcg32::new(seed, 40);
        let [x, y] = HALF_M;
        let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
        let walls: Vec<String> = (0..4)
            .map(|side| {
                let (from, to): ([f32; 2], [f32; 2]) = (corners[side], corners[(side + 1) % 4]);
                format!("{{ from_m = {from:?}, to_m = {to:?} }}")
            })
            .collect();
        let mut text = format!(
            "title = \"{}\"\nstart = {{ at_m = {START_M:?} }}\n[scene]\nwall = [{}]\n",
            self.name,
            walls.join(", ")
        );
        if self.columns {
            text.push_str(COLUMNS);
        }
        for index in 0..self.people {
            text.push_str(&self.person(index, &mut random));
        }
        text
    }

    /// The scene of a seed.
    ///
    /// # Errors
    /// None in practice: the text is written above.
    pub fn scenario(&self, seed: u64) -> anyhow::Result<Scenario> {
        Scenario::from_toml(&self.text(seed)).context(self.name)
    }

    fn person(&self, index: u32, random: &mut Pcg32) -> String {
        let mut at = place(random);
        let goals = match self.pattern {
            WalkPattern::Milling => (0..12).map(|_| place(random)).collect(),
            WalkPattern::Crossing => {
                let (side, along) = (random.uniform_between(-2.5, 2.5), random.uniform());
                let (from, to) = if index.is_multiple_of(2) {
                    ([MARGIN_M - HALF_M[0], side + 1.5], [HALF_M[0] - MARGIN_M, side + 1.5])
                } else {
                    ([side + 2.0, MARGIN_M - HALF_M[1]], [side + 2.0, HALF_M[1] - MARGIN_M])
                };
                at = [from[0] + along * (to[0] - from[0]), from[1] + along * (to[1] - from[1])];
                if random.bernoulli(0.5) { vec![to, from] } else { vec![from, to] }
            }
        };
        let stands = self.pattern == WalkPattern::Milling && random.bernoulli(0.125);
        let speed_mps = if stands { 0.0 } else { random.uniform_between(0.6, 1.5) };
        let kind = if random.bernoulli(0.12) { "child" } else { "adult" };
        let bodies = if self.varied { "varied" } else { "same" };
        let mut text = String::new();
        let _infallible = write!(
            text,
            "[[person]]\nkind = \"{kind}\"\nbodies = \"{bodies}\"\nat_m = {at:?}\nspeed_mps = {speed_mps}\ngoals_m = {goals:?}\n"
        );
        text
    }
}

/// Columns of half a metre and a partition.
const COLUMNS: &str = r#"furniture = [
  { kind = "box", at_m = [-4.5, 0.0], size_m = [0.5, 0.5] },
  { kind = "box", at_m = [4.5, 0.0], size_m = [0.5, 0.5] },
  { kind = "box", at_m = [-4.5, 4.0], size_m = [0.5, 0.5] },
  { kind = "box", at_m = [4.5, 4.0], size_m = [0.5, 0.5] },
  { kind = "box", at_m = [0.0, 3.5], size_m = [3.0, 0.1] },
]
"#;

/// Somewhere in the hall, not at the robot.
fn place(random: &mut Pcg32) -> [f32; 2] {
    let mut at = [0.0; 2];
    for _ in 0..20 {
        at = HALF_M.map(|half| random.uniform_between(MARGIN_M - half, half - MARGIN_M));
        if libm::hypotf(at[0] - START_M[0], at[1] - START_M[1]) > CLEAR_M {
            break;
        }
    }
    at
}
