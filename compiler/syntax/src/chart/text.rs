//! A chart as text, for `--emit ast`: one node per line.

use super::ast::{
    Action, ActionBody, Body, Call, Coil, Condition, Dialect, Interface, Permanent, PermanentKind, Settings, Step,
    StepData, Transition,
};
use crate::network;
use crate::network::ast::{Content, Network};
use crate::scl::ast::Name;
use crate::scl::text::{Lines, expr};

/// Its lines, each with its depth.
pub fn lines(chart: &Body) -> Vec<(usize, String)> {
    let mut out = Lines::default();
    out.body(chart);
    out.finish()
}

impl Lines {
    fn body(&mut self, chart: &Body) {
        self.line(match chart.dialect {
            Dialect::Classic => "chart",
            Dialect::Tia => "chart tia",
            Dialect::Sfc => "chart sfc",
        });
        self.inside(|out| {
            if chart.broken {
                out.line("broken");
            }
            out.settings(&chart.settings);
            chart.before.iter().for_each(|row| out.permanent("before", row));
            chart.steps.iter().for_each(|step| out.step(step));
            chart.transitions.iter().for_each(|transition| out.transition(transition));
            chart.after.iter().for_each(|row| out.permanent("after", row));
        });
    }

    fn settings(&mut self, settings: &Settings) {
        let Settings { interface, data, .. } = settings;
        let interface = interface.map(|interface| match interface {
            Interface::Minimum => "minimum",
            Interface::Standard => "standard",
            Interface::Maximum => "maximum",
            Interface::UserDefined => "user_defined",
        });
        let data = data.map(|data| match data {
            StepData::Individual => "individual",
            StepData::Array => "array",
            StepData::Minimized => "minimized",
        });
        let truth = |value: Option<bool>| value.map(|value| if value { "true" } else { "false" });
        let found = [
            ("interface", interface),
            ("data", data),
            ("skip_steps", truth(settings.skip_steps)),
            ("acknowledge", truth(settings.acknowledge)),
            ("manual_interlocks", truth(settings.manual_interlocks)),
            ("safe_activation", truth(settings.safe_activation)),
            ("locked_mode", truth(settings.locked_mode)),
        ];
        for (name, value) in found {
            if let Some(value) = value {
                self.line(format!("{name} {value}"));
            }
        }
    }

    fn permanent(&mut self, place: &str, row: &Permanent) {
        match &row.kind {
            PermanentKind::Coil { operand, coil, value } => {
                let coil = match coil {
                    Coil::Assign => "=",
                    Coil::Set => "S",
                    Coil::Reset => "R",
                };
                self.line(format!("{place} {} ({coil}) := {}", expr(operand), expr(value)));
            }
            PermanentKind::Call(call) => self.call(place, call),
            PermanentKind::Network(network) => {
                self.line(place);
                self.inside(|out| out.network(network));
            }
        }
    }

    fn step(&mut self, step: &Step) {
        let initial = if step.initial { "initial_step" } else { "step" };
        self.line(format!("{initial} {} {}", step.number, name(&step.name)));
        self.inside(|out| {
            out.comments(&step.comment);
            if let Some(time) = &step.maximum {
                out.line(format!("maximum {}", expr(time)));
            }
            if let Some(time) = &step.warning {
                out.line(format!("warning {}", expr(time)));
            }
            out.condition("interlock", step.interlock.as_ref());
            out.condition("supervision", step.supervision.as_ref());
            step.actions.iter().for_each(|action| out.action(action));
        });
    }

    fn transition(&mut self, transition: &Transition) {
        let mut head = format!("transition {} {}", transition.number, name(&transition.name));
        if transition.jump {
            head.push_str(" jump");
        }
        if transition.missing {
            head.push_str(" missing");
        }
        self.line(head);
        self.inside(|out| {
            out.comments(&transition.comment);
            if !transition.from.is_empty() {
                out.line(format!("from {}", names(&transition.from)));
            }
            if !transition.to.is_empty() {
                out.line(format!("to {}", names(&transition.to)));
            }
            if !transition.path.is_empty() {
                let path: Vec<String> = transition.path.iter().map(u32::to_string).collect();
                out.line(format!("path {}", path.join(" ")));
            }
            out.condition("condition", transition.condition.as_ref());
        });
    }

    fn comments(&mut self, comment: &[String]) {
        for line in comment {
            self.line(format!("comment {line:?}"));
        }
    }

    fn condition(&mut self, what: &str, condition: Option<&Condition>) {
        match condition {
            None => {}
            Some(Condition::Expression(value)) => self.line(format!("{what} {}", expr(value))),
            Some(Condition::Network(network)) => {
                self.line(what);
                self.inside(|out| out.network(network));
            }
            Some(Condition::Statements(list)) => {
                self.line(what);
                self.inside(|out| out.statements(list));
            }
        }
    }

    fn action(&mut self, action: &Action) {
        let mut head = action.event.map_or(String::new(), |event| format!("{} ", event.name()));
        head.push_str(action.qualifier.name());
        if action.interlock {
            head.push_str(" interlock");
        }
        match &action.body {
            ActionBody::Operand(operand) => self.line(format!("{head} {}", expr(operand))),
            ActionBody::Value { operand, value } => self.line(format!("{head} {} := {}", expr(operand), expr(value))),
            ActionBody::All { .. } => self.line(format!("{head} all")),
            ActionBody::Call(call) => self.call(&head, call),
            ActionBody::Network(network) => {
                self.line(&head);
                self.inside(|out| out.network(network));
            }
            ActionBody::Statements(list) => {
                self.line(&head);
                self.inside(|out| out.statements(list));
            }
            ActionBody::Error => self.line(format!("{head} error")),
        }
        if let Some(comment) = &action.comment {
            self.inside(|out| out.line(format!("comment {comment:?}")));
        }
    }

    fn call(&mut self, head: &str, call: &Call) {
        let instance = call.instance.as_ref().map_or(String::new(), |instance| format!(", {}", expr(instance)));
        self.line(format!("{head} call {}{instance}", expr(&call.block)));
        self.inside(|out| {
            for parameter in &call.parameters {
                let value = parameter.value.as_ref().map_or(String::new(), expr);
                out.line(format!("{} := {value}", name(&parameter.name)).trim_end());
            }
        });
    }

    fn network(&mut self, network: &Network) {
        let title = network.title.as_ref().map_or(String::new(), |title| format!(" {title:?}"));
        self.line(format!("{:?} network{title}", network.language));
        self.inside(|out| {
            out.comments(&network.comment);
            for label in &network.labels {
                out.line(format!("label {}", label.text));
            }
            match &network.content {
                Content::Graphic(graph) => network::text::graph(graph).iter().for_each(|line| out.line(line)),
                Content::Scl(list) => out.statements(list),
                Content::Stl(list) => out.line(format!("{} statements of STL", list.len())),
            }
        });
    }
}

fn name(name: &Name) -> String {
    format!("{:?}", name.text)
}

fn names(list: &[Name]) -> String {
    list.iter().map(name).collect::<Vec<_>>().join(", ")
}
