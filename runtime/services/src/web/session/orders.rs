//! What a page orders: it is checked and prepared here, and done at the cycle control point.

use std::sync::Arc;

use plcc_abi::ProgramImage;
use plcc_abi::services::Role;
use plcc_runtime::address::Place;
use plcc_runtime::cpu::Cpu;
use plcc_runtime::modify;
use plcc_runtime::options::Restart;
use plcc_runtime::signal::{Source, Value};
use plcc_runtime::watch::Settled;

use super::watched::source_in;
use crate::limits::{MODIFIED_LETTERS_MAX, MODIFIED_MAX, NAME_MAX};
use crate::link::Link;
use crate::web::messages::{Change, JobRow, Order};
use crate::web::users::May;

/// Result: why an order was refused, if it was. `None`: the CPU has ended.
pub(super) async fn carry_out(
    link: &Link,
    order: Order,
    may: May,
    client: u64,
    image: &Arc<ProgramImage>,
) -> Option<Option<String>> {
    let needed = match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Role::Look,
        Order::Modify(_) | Order::All { .. } | Order::Job { .. } => Role::Operate,
        // It outlasts the connection: a right to write programs, not values. Source: CPU manuals, protection levels.
        Order::Force(_)
        | Order::Unforce { .. }
        | Order::Stop
        | Order::Outputs { .. }
        | Order::Reset
        | Order::Run { .. } => Role::Change,
    };
    if let Err(why) = may.check(needed) {
        return Some(Some(why.to_string()));
    }
    let program = Arc::clone(image);
    let prepared = tokio::task::spawn_blocking(move || prepare(order, client, &program)).await.ok()?;
    match prepared {
        Ok(act) => Some(link.ask(act).await?.err()),
        Err(why) => Some(Some(why)),
    }
}

/// What an order asks of the CPU at the cycle control point.
type Act = Box<dyn FnOnce(&Cpu) -> Result<(), String> + Send>;

/// Does what an order needs before the CPU is asked: names are looked up and values read here, not in the cycle.
fn prepare(order: Order, client: u64, image: &Arc<ProgramImage>) -> Result<Act, String> {
    let program = Arc::clone(image);
    // Places are those of the program in which they were looked up.
    let is_same = move |cpu: &Cpu| match Arc::ptr_eq(&program, &cpu.image) {
        true => Ok(()),
        false => Err("the program has changed meanwhile: try again".to_string()),
    };
    let all = |rows: Vec<Change>| -> Result<Act, String> {
        if rows.len() > MODIFIED_MAX || rows.iter().map(|row| row.value.len()).sum::<usize>() > MODIFIED_LETTERS_MAX {
            return Err(format!(
                "{MODIFIED_MAX} values of {MODIFIED_LETTERS_MAX} letters in all can be modified at once"
            ));
        }
        let changed = rows.iter().map(|row| Changed::of(row, image)).collect::<Result<Vec<_>, _>>()?;
        let is_same = is_same.clone();
        Ok(Box::new(move |cpu| {
            is_same(cpu)?;
            cpu.for_client(client, || {
                changed.iter().try_for_each(|one| one.check(cpu))?;
                changed.iter().try_for_each(|one| one.write(cpu))
            })
        }))
    };
    let act: Act = match order {
        Order::Watch { .. } | Order::Status { .. } | Order::Obs | Order::Trace(_) => Box::new(|_| Ok(())),
        Order::Modify(change) => all(vec![change])?,
        Order::All { rows } => all(rows)?,
        Order::Job { rows } => {
            // Before anything is looked up.
            if rows.len() > modify::ROWS_MAX {
                return Err(format!("{} values can be modified in the cycle", modify::ROWS_MAX));
            }
            let row = |row: &JobRow| {
                check_length(&row.name, &row.value)?;
                let settled = Settled::find(&row.name, &row.value, row.format, image);
                let settled = settled.map_err(|why| named(&row.name, &why))?;
                Ok::<_, String>(modify::Row { settled, trigger: row.trigger, every_cycle: row.every })
            };
            let rows = rows.iter().map(row).collect::<Result<Vec<_>, _>>()?;
            Box::new(move |cpu| {
                is_same(cpu)?;
                cpu.begin_job(client, rows)
            })
        }
        Order::Force(change) => {
            check_length(&change.name, &change.value)?;
            Box::new(move |cpu| cpu.force_as(&change.name, &change.value, change.format))
        }
        Order::Unforce { name } => Box::new(move |cpu| cpu.unforce(name.as_deref())),
        Order::Stop => Box::new(|cpu| {
            cpu.stop_by_request();
            Ok(())
        }),
        Order::Outputs { enable: true } => Box::new(move |cpu| cpu.enable_outputs(client)),
        // No matter who has enabled them: disabled outputs are safe.
        Order::Outputs { enable: false } => Box::new(|cpu| {
            cpu.end_enabling();
            Ok(())
        }),
        Order::Reset => Box::new(Cpu::request_memory_reset),
        Order::Run { restart } => Box::new(move |cpu| run(cpu, &restart)),
    };
    Ok(act)
}

fn run(cpu: &Cpu, restart: &str) -> Result<(), String> {
    let kind = match restart {
        "warm" => Restart::Warm,
        "cold" => Restart::Cold,
        _ => return Err(format!("`{restart}` is not a restart: warm or cold")),
    };
    if !cpu.is_stopped() {
        return Err("the CPU is in RUN".to_string());
    }
    match cpu.request_restart(kind) {
        true => Ok(()),
        false => Err(format!("this CPU has no {restart} restart")),
    }
}

/// What a value is to be, found and read, as far as that needs no CPU.
enum Changed {
    /// A place in memory and its bits.
    Settled(Settled),
    /// A text, a number with a unit.
    Value(Source, Value),
}

impl Changed {
    fn of(change: &Change, image: &ProgramImage) -> Result<Changed, String> {
        check_length(&change.name, &change.value)?;
        if change.format.is_some() {
            let settled = Settled::find(&change.name, &change.value, change.format, image);
            return settled.map(Changed::Settled).map_err(|why| named(&change.name, &why));
        }
        let source = source_in(image, &change.name)?;
        let value = source.parse(&change.value, image).map_err(|why| named(&change.name, &why))?;
        Ok(Changed::Value(source, value))
    }

    fn check(&self, cpu: &Cpu) -> Result<(), String> {
        match self {
            Changed::Settled(settled) => cpu.check_modifiable(settled),
            Changed::Value(source, _) => {
                source.check(cpu)?;
                source.check_settable()?;
                if let Some(address) = source.address() {
                    cpu.check_enabled(address.place)?;
                }
                match source.address().map(|address| address.place) {
                    Some(Place::Db(number, _)) if cpu.is_read_only(number) => {
                        Err(format!("DB {number} is write-protected"))
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    fn write(&self, cpu: &Cpu) -> Result<(), String> {
        match self {
            Changed::Settled(settled) => cpu.write(&settled.address, settled.bits),
            Changed::Value(source, value) => source.write(cpu, value),
        }
    }
}

/// A message about a value says whose it is.
fn named(name: &str, why: &str) -> String {
    if why.contains(name) { why.to_string() } else { format!("{name}: {why}") }
}

fn check_length(name: &str, value: &str) -> Result<(), String> {
    match name.len() > NAME_MAX || value.len() > NAME_MAX {
        true => Err(format!("a name and a value have at most {NAME_MAX} letters")),
        false => Ok(()),
    }
}
