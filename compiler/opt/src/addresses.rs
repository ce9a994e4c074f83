//! Direct addressing where the address is known at compile time.
//!
//! The DBs of the program are never deleted or moved, so that base and length of a DB with a constant number are constants. An
//! access with a constant base, or with the address of a place as base, is made direct where it surely is in the region;
//! then its aliases are known.
//!
//! ```text
//! v1 = const.i32 10
//! v2 = db_base v1            ; 0x400000
//! v3 = load.i16 anydb[v2]+4  ; load.i16 DB10 4
//! ```
//!
//! The distance of two places in one region is a constant: how far a frame is from that of its caller, after inlining.
//!
//! A copy of 1, 2, 4 or 8 bytes becomes a load and a store, which other passes understand.

use plcc_abi::layout;
use plcc_ir::analysis::reverse_postorder;
use plcc_ir::{Address, BinaryOp, Function, Inst, InstData, Region, StaticDb, Type, Value};

use crate::known_bits::unsigned_max;
use crate::surroundings::Surroundings;

/// Makes addresses direct in a function. Result: whether anything changed.
pub fn resolve_addresses(function: &mut Function, surroundings: &Surroundings) -> bool {
    Resolver { by_number: &surroundings.dbs, by_address: &surroundings.dbs_by_address, function }.run()
}

struct Resolver<'a> {
    by_number: &'a [StaticDb],
    by_address: &'a [StaticDb],
    function: &'a mut Function,
}

impl Resolver<'_> {
    fn run(&mut self) -> bool {
        let mut changed = false;
        let mut out = Vec::new();
        // Bases are resolved before their uses.
        for block in reverse_postorder(self.function) {
            let mut insts = std::mem::take(&mut self.function.blocks[block].insts);
            for &inst in &insts {
                changed |= self.visit(inst, &mut out);
                out.push(inst);
            }
            insts.clear();
            insts.append(&mut out);
            self.function.blocks[block].insts = insts;
        }
        changed
    }

    /// Result: whether the instruction is another one.
    fn visit(&mut self, inst: Inst, out: &mut Vec<Inst>) -> bool {
        let mut changed = false;
        let mut data = std::mem::replace(&mut self.function.insts[inst], InstData::Const { bits: 0 });
        match &mut data {
            InstData::Load { addr } => {
                let bytes = self.function.ty(self.function.result(inst)).bytes();
                changed = self.resolve(addr, bytes);
            }
            InstData::Store { addr, value } => changed = self.resolve(addr, self.function.ty(*value).bytes()),
            InstData::LoadBit { addr, .. } | InstData::StoreBit { addr, .. } => changed = self.resolve(addr, 1),
            InstData::Clear { addr, len } => changed = self.resolve(addr, *len),
            InstData::Copy { to, from, len } => {
                let (to_bytes, from_bytes) = (*len, *len);
                changed = self.resolve(to, to_bytes);
                changed |= self.resolve(from, from_bytes);
                let ty = match *len {
                    1 => Some(Type::I8),
                    2 => Some(Type::I16),
                    4 => Some(Type::I32),
                    8 => Some(Type::I64),
                    _ => None,
                };
                if let Some(ty) = ty.filter(|_| !to.region.is_host_order() && !from.region.is_host_order()) {
                    let loc = self.function.locs[inst];
                    let load = self.function.make_inst(InstData::Load { addr: *from }, &[ty], loc);
                    out.push(load);
                    data = InstData::Store { addr: *to, value: self.function.result(load) };
                    changed = true;
                }
            }
            InstData::AddressOf { addr } => {
                changed = self.resolve(addr, 0);
                if let Some(bits) = self.constant_address(addr) {
                    data = InstData::Const { bits };
                    changed = true;
                }
            }
            InstData::DbBase { number } => {
                if let Some(db) = self.static_db(*number) {
                    data = InstData::Const { bits: u64::from(db.address) };
                    changed = true;
                }
            }
            InstData::DbLength { number } => {
                if let Some(db) = self.static_db(*number) {
                    data = InstData::Const { bits: u64::from(db.length) };
                    changed = true;
                }
            }
            InstData::Binary { op: BinaryOp::Isub, args: [a, b] } => {
                if let Some(bits) = self.distance(*a, *b) {
                    data = InstData::Const { bits };
                    changed = true;
                }
            }
            InstData::Const { .. }
            | InstData::Unary { .. }
            | InstData::Binary { .. }
            | InstData::IntCompare { .. }
            | InstData::FloatCompare { .. }
            | InstData::Convert { .. }
            | InstData::Select { .. }
            | InstData::Call { .. }
            | InstData::CallRuntime { .. }
            | InstData::FrameBase { .. }
            | InstData::Jump { .. }
            | InstData::Branch { .. }
            | InstData::Switch { .. }
            | InstData::Return { .. } => {}
        }
        self.function.insts[inst] = data;
        changed
    }

    /// The difference of the addresses of two places in one region.
    fn distance(&self, a: Value, b: Value) -> Option<u64> {
        let place = |value: Value| match self.function.defining(value) {
            Some(InstData::AddressOf { addr }) if addr.base.is_none() => Some(*addr),
            _ => None,
        };
        let (a, b) = (place(a)?, place(b)?);
        (a.region == b.region).then_some(u64::from(a.offset.wrapping_sub(b.offset)))
    }

    fn static_db(&self, number: Value) -> Option<StaticDb> {
        let number = u16::try_from(self.function.constant(number)?).ok()?;
        let index = self.by_number.binary_search_by_key(&number, |db| db.number).ok()?;
        Some(self.by_number[index])
    }

    /// Makes `addr` simpler, step by step. `bytes` is the size of the access. Result: whether it is simpler.
    fn resolve(&self, addr: &mut Address, bytes: u32) -> bool {
        let mut changed = false;
        while let Some(simpler) = self.simpler(addr, bytes) {
            *addr = simpler;
            changed = true;
        }
        changed
    }

    fn simpler(&self, addr: &Address, bytes: u32) -> Option<Address> {
        let base = addr.base?;
        match *self.function.defining(base)? {
            InstData::Const { bits } => {
                let offset = (bits as u32).checked_add(addr.offset)?;
                match addr.region {
                    Region::AnyDb | Region::Any => self.place_at(offset, bytes, addr.region == Region::Any),
                    Region::State
                    | Region::I
                    | Region::Q
                    | Region::M
                    | Region::System
                    | Region::Cells
                    | Region::L
                    | Region::V
                    | Region::Db(_) => {
                        let direct = Address::direct(addr.region, offset);
                        self.is_inside(&direct, bytes).then_some(direct)
                    }
                }
            }
            InstData::AddressOf { addr: place } if matches!(addr.region, Region::Any | Region::AnyDb) => {
                let offset = place.offset.checked_add(addr.offset)?;
                let moved = Address { offset, ..place };
                // After the end of its region something else begins.
                let inside = place.base.is_none() && self.is_inside(&moved, bytes);
                inside.then_some(moved)
            }
            InstData::Binary { op: BinaryOp::Iadd, args: [x, c] } => {
                let constant = self.function.constant(c)?;
                // The sum must not wrap, since the machine adds in 64 bits.
                let offset = addr.offset.checked_add(u32::try_from(constant).ok()?)?;
                let fits = unsigned_max(self.function, x).checked_add(constant)? <= u64::from(u32::MAX);
                fits.then_some(Address { region: addr.region, base: Some(x), offset })
            }
            _ => None,
        }
    }

    /// The direct address of `bytes` bytes at `offset` from the memory base.
    fn place_at(&self, offset: u32, bytes: u32, anywhere: bool) -> Option<Address> {
        let index = self.by_address.partition_point(|db| db.address <= offset).checked_sub(1);
        if let Some(db) = index.map(|index| &self.by_address[index]) {
            let direct = Address::direct(Region::Db(db.number), offset - db.address);
            if self.is_inside(&direct, bytes) {
                return Some(direct);
            }
        }
        let areas =
            [(Region::I, layout::I), (Region::Q, layout::Q), (Region::M, layout::M), (Region::System, layout::SYSTEM)];
        let (region, start) =
            areas.into_iter().find(|(_, start)| (*start..start + layout::AREA_BYTES).contains(&offset))?;
        let direct = Address::direct(region, offset - start);
        (anywhere && self.is_inside(&direct, bytes)).then_some(direct)
    }

    /// True if a direct access is in its region, as the verifier requires.
    fn is_inside(&self, addr: &Address, bytes: u32) -> bool {
        let limit = match addr.region {
            Region::State | Region::I | Region::Q | Region::M | Region::System => layout::AREA_BYTES,
            Region::Cells => layout::CELLS_BYTES,
            Region::L => self.function.local_bytes(),
            Region::V => layout::L_CLASS_BYTES,
            Region::Db(number) => match self.by_number.binary_search_by_key(&number, |db| db.number) {
                Ok(index) => self.by_number[index].length,
                Err(_) => return false,
            },
            Region::AnyDb | Region::Any => return false,
        };
        u64::from(addr.offset) + u64::from(bytes) <= u64::from(limit)
    }

    /// The offset from the memory base that a direct address in a fixed region has.
    fn constant_address(&self, addr: &Address) -> Option<u64> {
        if addr.base.is_some() {
            return None;
        }
        let start = match addr.region {
            Region::State => layout::STATE,
            Region::I => layout::I,
            Region::Q => layout::Q,
            Region::M => layout::M,
            Region::System => layout::SYSTEM,
            Region::Cells => layout::T,
            Region::Db(number) => {
                let index = self.by_number.binary_search_by_key(&number, |db| db.number).ok()?;
                self.by_number[index].address
            }
            Region::L | Region::V | Region::AnyDb | Region::Any => return None,
        };
        start.checked_add(addr.offset).map(u64::from)
    }
}

#[cfg(test)]
mod tests {
    use crate::tests::check_pass;

    fn check(body: &str, expected: &str) {
        let around =
            |body: &str| format!("db 10 at 0x400000 length 20\nfunc @F -> i32 frame 16 {{\nb0(v0: i32):\n{body}\n}}\n");
        check_pass("addresses", &around(body), &around(expected));
    }

    #[test]
    fn static_dbs_are_direct() {
        check(
            "v1 = const.i32 10\nv2 = db_base v1\nv3 = db_length v1\nv4 = load.i16 anydb[v2]+4\nstore.i16 anydb[v2]+18, \
             v4\nret v3",
            "v1 = const.i32 10\nv2 = const.i32 4194304\nv3 = const.i32 20\nv4 = load.i16 DB10 4\nstore.i16 DB10 18, v4\nret \
             v3",
        );
    }

    #[test]
    fn what_lies_outside_stays() {
        let text = "v1 = const.i32 4194304\nv2 = load.i16 anydb[v1]+19\nv3 = const.i32 11\nv4 = db_base v3\nret v0";
        check(text, text);
    }

    #[test]
    fn addresses_of_places_are_those_places() {
        check(
            "v1 = address L 4\nv2 = load.i32 any[v1]+8\nv3 = load.i32 any[v1]+12\nv4 = address M 6\nv5 = load.i8 any[v4]+1\nret \
             v2",
            &format!(
                "v1 = address L 4\nv2 = load.i32 L 12\nv3 = load.i32 any[v1]+12\nv4 = const.i32 {}\nv5 = load.i8 M 7\nret v2",
                plcc_abi::layout::M + 6
            ),
        );
    }

    #[test]
    fn small_copies_are_a_load_and_a_store() {
        check("copy M 0, L 4, 2\nret v0", "v1 = load.i16 L 4\nstore.i16 M 0, v1\nret v0");
        let text = "copy M 0, L 4, 3\nret v0";
        check(text, text);
    }
}
