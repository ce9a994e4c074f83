//! Addresses of accesses that ranges make simpler.
//!
//! ```text
//! v2 = imul v1, 14           ; v1 is 0 to 3
//! v3 = address DB1[v2]+4
//! v4 = load.i16 any[v3]+6    ; load.i16 DB1[v2]+10, if DB 1 is that long
//! ```

use plcc_abi::layout;
use plcc_ir::{Address, Function, Inst, InstData, Region};

use super::analysis::Ranges;
use super::change::{Change, sum_with_constant};
use super::interval::Interval;
use crate::surroundings::Surroundings;

/// The simpler addresses of an instruction.
pub fn addresses(function: &Function, ranges: &Ranges<'_>, surroundings: &Surroundings, inst: Inst) -> Option<Change> {
    let data = &function.insts[inst];
    let bytes = match data {
        InstData::Load { .. } => function.ty(function.result(inst)).bytes(),
        InstData::Store { value, .. } => function.ty(*value).bytes(),
        InstData::LoadBit { .. } | InstData::StoreBit { .. } => 1,
        InstData::Clear { len, .. } | InstData::Copy { len, .. } => *len,
        _ => return None,
    };
    let mut simpler = [None; 2];
    let mut index = 0;
    data.for_each_address(|addr| {
        simpler[index] = of_place(function, ranges, surroundings, addr, bytes)
            .or_else(|| of_area(ranges, surroundings, addr, bytes))
            .or_else(|| with_constant(function, ranges, addr));
        index += 1;
    });
    simpler.iter().any(Option::is_some).then_some(Change::Addresses(simpler))
}

/// Accesses at sums of one value and different constants are at one sum and different offsets: a pointer of an S7-200 minus that to V memory,
/// in a loop of which several passes are one. The sum is what the value is above its least number.
pub fn from_the_least(function: &Function, ranges: &Ranges<'_>, inst: Inst) -> Option<Change> {
    let (InstData::Load { addr }
    | InstData::Store { addr, .. }
    | InstData::LoadBit { addr, .. }
    | InstData::StoreBit { addr, .. }) = &function.insts[inst]
    else {
        return None;
    };
    let (x, by) = sum_with_constant(function, ranges, addr.base?)?;
    let (of_x, of_sum) = (ranges.get(x)?, ranges.get(addr.base?)?);
    let is_exact = of_sum.lo == of_x.lo.checked_add(by)? && of_x.hi.checked_add(by)? <= i64::from(i32::MAX);
    let fits = of_x.is_natural() && of_sum.is_natural() && is_exact && by < 0 && by != -of_x.lo;
    // The offset grows by what the sum is at least.
    let offset = i64::from(addr.offset).checked_add(of_sum.lo)?;
    (fits && offset <= i64::from(i32::MAX) && function.constant(x).is_none()).then_some(Change::AddressFrom(
        x,
        -of_x.lo as u64,
        Address { offset: offset as u32, ..*addr },
    ))
}

/// Gives an instruction those of the addresses that are there.
pub fn set_addresses(data: &mut InstData, [first, second]: [Option<Address>; 2]) {
    match data {
        InstData::Load { addr }
        | InstData::Store { addr, .. }
        | InstData::LoadBit { addr, .. }
        | InstData::StoreBit { addr, .. }
        | InstData::Clear { addr, .. } => *addr = first.unwrap_or(*addr),
        InstData::Copy { to, from, .. } => {
            *to = first.unwrap_or(*to);
            *from = second.unwrap_or(*from);
        }
        _ => {}
    }
}

/// The constant in the base of an address belongs to its offset.
fn with_constant(function: &Function, ranges: &Ranges<'_>, addr: &Address) -> Option<Address> {
    let (x, by) = sum_with_constant(function, ranges, addr.base?)?;
    let of_x = ranges.get(x)?;
    let fits = of_x.is_natural() && of_x.lo.checked_add(by)? >= 0 && of_x.hi.checked_add(by)? <= i64::from(i32::MAX);
    let offset = i64::from(addr.offset) + by;
    (fits && (0..=i64::from(i32::MAX)).contains(&offset) && function.constant(x).is_none()).then_some(Address {
        base: Some(x),
        offset: offset as u32,
        ..*addr
    })
}

/// What is reached by the address of a place is in the region of that place, if the base of the place is small enough.
fn of_place(
    function: &Function,
    ranges: &Ranges<'_>,
    surroundings: &Surroundings,
    addr: &Address,
    bytes: u32,
) -> Option<Address> {
    if !matches!(addr.region, Region::Any | Region::AnyDb) {
        return None;
    }
    let &InstData::AddressOf { addr: place } = function.defining(addr.base?)? else { return None };
    let length = match place.region {
        Region::I | Region::Q | Region::M => layout::AREA_BYTES,
        Region::L => function.local_bytes(),
        Region::Db(number) => {
            let index = surroundings.dbs.binary_search_by_key(&number, |db| db.number).ok()?;
            surroundings.dbs[index].length
        }
        Region::State | Region::System | Region::Cells | Region::V | Region::AnyDb | Region::Any => return None,
    };
    let base = place.base.map_or(Some(Interval::between(0, 0)), |base| ranges.get(base))?;
    let offset = place.offset.checked_add(addr.offset)?;
    let end = base.hi.checked_add(i64::from(offset) + i64::from(bytes))?;
    (base.is_natural() && end <= i64::from(length)).then_some(Address { offset, ..place })
}

/// What begins and ends in a DB or an area, whatever number of its range the base is, is there.
fn of_area(ranges: &Ranges<'_>, surroundings: &Surroundings, addr: &Address, bytes: u32) -> Option<Address> {
    let anywhere = match addr.region {
        Region::Any => true,
        Region::AnyDb => false,
        _ => return None,
    };
    let base = ranges.get(addr.base?).filter(|base| base.is_natural())?;
    let start = base.lo.checked_add(i64::from(addr.offset))?;
    let end = base.hi.checked_add(i64::from(addr.offset) + i64::from(bytes))?;
    let dbs = &surroundings.dbs_by_address;
    let db = dbs.partition_point(|db| i64::from(db.address) <= start).checked_sub(1).map(|index| dbs[index]);
    let db = db.map(|db| (Region::Db(db.number), db.address, db.length));
    let areas = [(Region::I, layout::I), (Region::Q, layout::Q), (Region::M, layout::M)];
    let areas = areas.into_iter().filter(|_| anywhere).map(|(region, first)| (region, first, layout::AREA_BYTES));
    db.into_iter().chain(areas).find_map(|(region, first, length)| {
        let offset = addr.offset.checked_sub(first)?;
        let is_inside = i64::from(first) <= start && end <= i64::from(first) + i64::from(length);
        is_inside.then_some(Address { region, base: addr.base, offset })
    })
}
