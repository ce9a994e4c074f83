//! `[plant]` of a scenario.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::rc::Rc;

use plcc_abi::ProgramImage;
use serde::Deserialize;
use toml::Spanned;

use super::expression::{self, Expression};
use super::{Equation, Plant, STEP_DEFAULT, STEP_LEAST, Write};
use crate::address::{Address, Place};
use crate::options::parse_duration;
use crate::s7200::Part;
use crate::signal::Source;

/// As it is in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlantText {
    step: Option<Spanned<String>>,
    #[serde(default)]
    parameters: BTreeMap<String, Spanned<f64>>,
    #[serde(default)]
    state: BTreeMap<String, Spanned<f64>>,
    #[serde(default)]
    read: BTreeMap<String, Spanned<String>>,
    #[serde(default)]
    equations: Vec<Spanned<String>>,
    #[serde(default)]
    write: BTreeMap<String, Spanned<String>>,
}

/// Offset in the file and message.
type Wrong = (usize, String);

impl PlantText {
    /// The plant of a program. `line` returns the line of an offset. `Err`: offset and message.
    pub(crate) fn plant(&self, image: &ProgramImage, line: &dyn Fn(usize) -> u32) -> Result<Plant, Wrong> {
        let mut reader = Reader { image, line, plant: empty(self.step()?) };
        for (name, value) in self.parameters.iter().chain(&self.state) {
            let at = value.span().start;
            if !value.get_ref().is_finite() {
                return Err((at, format!("{name} needs a number")));
            }
            let index = reader.add(name, at)?;
            reader.plant.values[index] = *value.get_ref();
            reader.plant.settable.insert(index);
        }
        for (name, source) in &self.read {
            let at = source.span().start;
            let text = source.get_ref();
            let is_turned = !expression::is_name(name) && expression::is_name(text);
            if is_turned && reader.source(name, is_output, "").is_ok() {
                return Err((at, format!("the name of the value is on the left; write `{text} = \"{name}\"`")));
            }
            let index = reader.add(name, at)?;
            let source =
                reader.source(source.get_ref(), is_output, "an output (Q, PQ, AO)").map_err(|text| (at, text))?;
            reader.plant.reads.push((index, source));
        }
        for equation in &self.equations {
            reader.equation(equation, |name| self.state.contains_key(name))?;
        }
        for (name, text) in &self.write {
            reader.write(name, text)?;
        }
        Ok(reader.plant)
    }

    fn step(&self) -> Result<u64, Wrong> {
        let Some(text) = &self.step else { return Ok(STEP_DEFAULT) };
        match parse_duration(text.get_ref()) {
            Ok(step) if step.0 >= STEP_LEAST => Ok(step.0),
            Ok(_) => Err((text.span().start, "the step of a plant must be at least 1ms".to_string())),
            Err(message) => Err((text.span().start, message)),
        }
    }
}

fn empty(step: u64) -> Plant {
    let names = vec!["t".to_string(), "dt".to_string()];
    Plant {
        step,
        numbers: names.iter().enumerate().map(|(index, name)| (name.clone(), index)).collect::<HashMap<_, _>>(),
        values: vec![0.0; names.len()],
        names,
        settable: HashSet::new(),
        reads: Vec::new(),
        equations: Vec::new(),
        writes: Vec::new(),
        time: 0,
        failed: false,
    }
}

fn is_output(address: &Address) -> bool {
    matches!(address.place, Place::Output(_) | Place::PeripheralOutput(_) | Place::S7200(Part::AnalogOutput, _))
}

fn is_input(address: &Address) -> bool {
    matches!(address.place, Place::Input(_) | Place::PeripheralInput(_) | Place::S7200(Part::AnalogInput, _))
}

struct Reader<'a> {
    image: &'a ProgramImage,
    line: &'a dyn Fn(usize) -> u32,
    plant: Plant,
}

impl Reader<'_> {
    /// A value more, 0 until it is set.
    fn add(&mut self, name: &str, at: usize) -> Result<usize, Wrong> {
        if !expression::is_name(name) {
            return Err((
                at,
                format!(
                    "`{name}` cannot be the name of a value: use letters, digits and _, and not the name of a function"
                ),
            ));
        }
        if self.plant.find(name).is_some() {
            return Err((at, format!("the plant has two values `{name}`")));
        }
        self.plant.numbers.insert(name.to_string(), self.plant.names.len());
        self.plant.names.push(name.to_string());
        self.plant.values.push(0.0);
        Ok(self.plant.names.len() - 1)
    }

    fn source(&self, text: &str, fits: fn(&Address) -> bool, what: &str) -> Result<Source, String> {
        let source = Source::find(text, self.image, None)?;
        source.address().filter(|address| fits(address)).ok_or_else(|| format!("`{text}` is not {what}"))?;
        Ok(source)
    }

    fn equation(&mut self, equation: &Spanned<String>, is_state: impl Fn(&str) -> bool) -> Result<(), Wrong> {
        let at = equation.span().start;
        let text = equation.get_ref();
        if text.contains(';') {
            let parts: Vec<String> = text.split(';').map(|part| format!("\"{}\"", part.trim())).collect();
            let list = parts.iter().filter(|part| part.len() > 2).map(String::as_str).collect::<Vec<&str>>().join(", ");
            return Err((at, format!("`{text}`: each equation is a text; write {list}")));
        }
        let (name, value) = text.split_once('=').ok_or_else(|| (at, format!("`{text}`: write `name = expression`")))?;
        // `level := 1`, `level == 1`
        let (plain, rest) = (name.trim_end_matches(':').trim(), value.trim_start_matches('=').trim());
        if name.trim_end().ends_with(':') || value.starts_with('=') {
            return Err((at, format!("`{text}`: an equation has one `=`; write `{plain} = {rest}`")));
        }
        let name = name.trim();
        let expression = self.expression(value, at)?;
        let target = match self.plant.find(name) {
            Some(index) if is_state(name) => index,
            Some(_) => return Err((at, format!("`{name}` already has a value; only a state changes on its own"))),
            None => self.add(name, at)?,
        };
        self.plant.equations.push(Equation { target, expression, line: (self.line)(at) });
        Ok(())
    }

    fn write(&mut self, name: &str, text: &Spanned<String>) -> Result<(), Wrong> {
        let at = text.span().start;
        let turned = text.get_ref();
        let is_value = |name: &str| self.plant.find(name).is_some();
        if is_value(name) && !is_value(turned) && self.source(turned, is_input, "").is_ok() {
            return Err((at, format!("the input is on the left; write `\"{turned}\" = \"{name}\"`")));
        }
        let input = self.source(name, is_input, "an input (I, PI, AI)").map_err(|text| (at, text))?;
        let expression = self.expression(text.get_ref(), at)?;
        self.plant.writes.push(Write { name: name.to_string(), input, expression, line: (self.line)(at) });
        Ok(())
    }

    fn expression(&self, text: &str, at: usize) -> Result<Rc<Expression>, Wrong> {
        let is_known = |name: &str| self.plant.find(name).is_some();
        Expression::parse(text.trim(), is_known).map(Rc::new).map_err(|message| (at, message))
    }
}
