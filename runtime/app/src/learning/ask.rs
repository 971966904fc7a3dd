//! `floorguard ask`: what the robot has learned about a place, as answers.

use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};

use super::learn::DEFAULT_MODEL;
use floorguard_host::outcome::BadInput;
use floorguard_robot::environment::{
    Answer, Calendar, Model, Question, WeekHours, Zone, answer, load, pictures,
};

/// What to ask.
#[derive(Clone, Debug, Args)]
pub struct AskArguments {
    /// The question.
    #[command(subcommand)]
    pub question: AskQuestion,
    /// The model that `floorguard learn` wrote.
    #[arg(long, global = true, default_value = DEFAULT_MODEL)]
    pub model: PathBuf,
    /// The moment of the question, on the clock on the wall: 2026-04-06T08:00; without it, now.
    #[arg(long, global = true)]
    pub now: Option<String>,
    /// One JSON object on standard output.
    #[arg(long, global = true)]
    pub json: bool,
}

/// A question.
#[derive(Clone, Debug, Subcommand)]
pub enum AskQuestion {
    /// When is the best time to clean a zone?
    #[command(after_help = "Example:\n  floorguard ask best-time --zone aisle=0,0,12,3 --minutes 30")]
    BestTime {
        /// Name of the zone, or NAME=X0,Y0,X1,Y1 in metres.
        #[arg(long)]
        zone: String,
        /// How long the work takes.
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1_440))]
        minutes: u32,
        /// How far to look ahead.
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=7))]
        days: u32,
        /// How many people one would rather meet than wait for an hour.
        #[arg(long, default_value_t = 0.0, value_parser = cost)]
        delay_cost: f32,
    },
    /// Which zone should be cleaned now?
    #[command(after_help = "Example:\n  floorguard ask best-zone --minutes 30")]
    BestZone {
        /// How long there is time.
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1_440))]
        minutes: u32,
    },
    /// Can a zone be cleaned wet now, or only dry?
    #[command(after_help = "Example:\n  floorguard ask wet-or-dry --zone aisle=0,0,12,3")]
    WetOrDry {
        /// Name of the zone, or NAME=X0,Y0,X1,Y1 in metres.
        #[arg(long)]
        zone: String,
        /// Probability of somebody coming while the floor dries that is accepted.
        #[arg(long, default_value_t = 0.2, value_parser = share)]
        threshold: f32,
    },
    /// Where is dirt to be expected?
    #[command(after_help = "Example:\n  floorguard ask dirt")]
    Dirt,
    /// Where do people walk in these hours?
    #[command(after_help = "Example:\n  floorguard ask people --from 8 --to 18 --days workdays")]
    People {
        /// From this full hour on.
        #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=23))]
        from: u8,
        /// Up to this full hour.
        #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u8).range(1..=24))]
        to: u8,
        /// On these days, separated by commas: mon, tue …, workdays, weekend; without it, on all.
        #[arg(long, value_delimiter = ',')]
        days: Vec<String>,
        /// Write the heat map of these hours to this picture.
        #[arg(long)]
        picture: Option<PathBuf>,
    },
}

fn share(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err(format!("'{text}' is not a share between 0 and 1")),
    }
}

/// Runs the command.
///
/// # Errors
/// No model, an invalid zone or an invalid moment.
pub fn run(arguments: &AskArguments) -> anyhow::Result<()> {
    let answer = ask(arguments).map_err(|error| BadInput(format!("{error:#}")))?;
    if arguments.json {
        tell!("{}", serde_json::to_string(&answer)?)?;
        return Ok(());
    }
    tell!("{}", answer.answer)?;
    tell!("  how sure: {}", answer.confidence)?;
    for line in &answer.evidence {
        tell!("  {line}")?;
    }
    Ok(())
}

fn ask(arguments: &AskArguments) -> anyhow::Result<Answer> {
    let path = arguments.model.display();
    let loaded = load(&arguments.model)?.with_context(|| {
        format!("{path}: there is no model; write one with: floorguard learn --model {path} TRACKS")
    })?;
    loaded.passed_over.iter().for_each(|what| say!("passed over: {what}"));
    let model = loaded.model;
    let now = match &arguments.now {
        Some(text) => model.calendar.parse(text)?,
        None => Calendar::now(),
    };
    let question = question(&arguments.question, &model)?;
    if let (AskQuestion::People { picture: Some(picture), .. }, Question::People { hours }) =
        (&arguments.question, &question)
    {
        pictures::write(picture, &model, pictures::Layer::Trajectories, Some(hours))?;
    }
    Ok(answer(&model, &question, now))
}

/// Nothing below zero: nobody would rather wait and meet more.
fn cost(text: &str) -> Result<f32, String> {
    let cost = text.parse::<f32>().map_err(|problem| problem.to_string())?;
    if cost >= 0.0 && cost.is_finite() {
        Ok(cost)
    } else {
        Err("give a number of people, 0 or more".to_owned())
    }
}

fn question(asked: &AskQuestion, model: &Model) -> anyhow::Result<Question> {
    let zone = |text: &str| Zone::parse(text, &model.zones_or_tiles());
    Ok(match asked {
        AskQuestion::BestTime { zone: name, minutes, days, delay_cost } => {
            Question::BestTime { zone: zone(name)?, minutes: *minutes, days: *days, delay_cost: *delay_cost }
        }
        AskQuestion::BestZone { minutes } => Question::BestZone { minutes: *minutes },
        AskQuestion::WetOrDry { zone: name, threshold } => {
            Question::WetOrDry { zone: zone(name)?, threshold: *threshold }
        }
        AskQuestion::Dirt => Question::Dirt,
        AskQuestion::People { from, to, days, .. } => {
            Question::People { hours: WeekHours::new(*from, *to, days)? }
        }
    })
}
