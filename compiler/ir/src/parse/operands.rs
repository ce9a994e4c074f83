//! Operands of an instruction: values, targets of jumps, addresses.

use super::LineResult;
use super::body::FunctionParser;
use super::cursor::Cursor;
use crate::entities::Value;
use crate::instructions::{Address, BlockCall, Region, Values};

impl FunctionParser<'_> {
    pub(super) fn pair(&mut self, cursor: &mut Cursor) -> LineResult<[Value; 2]> {
        let first = self.value(cursor)?;
        cursor.expect(",")?;
        Ok([first, self.value(cursor)?])
    }

    /// `(v1, v2)`
    pub(super) fn arguments(&mut self, cursor: &mut Cursor) -> LineResult<Values> {
        let mut args = Values::new();
        cursor.expect("(")?;
        if cursor.take(")") {
            return Ok(args);
        }
        args.push(self.value(cursor)?);
        while cursor.take(",") {
            args.push(self.value(cursor)?);
        }
        cursor.expect(")")?;
        Ok(args)
    }

    /// `b1(v2)`
    pub(super) fn target(&mut self, cursor: &mut Cursor) -> LineResult<BlockCall> {
        let block = self.block(cursor)?;
        let args = if cursor.peek("(") { self.arguments(cursor)? } else { Values::new() };
        Ok(BlockCall { block, args })
    }

    /// `M 20` or `M[v4]+8`
    pub(super) fn address(&mut self, cursor: &mut Cursor) -> LineResult<Address> {
        let name = cursor.word()?;
        let region = region_named(name).ok_or_else(|| format!("`{name}` is not a memory region"))?;
        let base = if cursor.take("[") {
            let base = self.value(cursor)?;
            cursor.expect("]")?;
            cursor.expect("+")?;
            Some(base)
        } else {
            None
        };
        Ok(Address { region, base, offset: cursor.number()? })
    }

    /// `Q 4.0`
    pub(super) fn bit_address(&mut self, cursor: &mut Cursor) -> LineResult<(Address, u8)> {
        let addr = self.address(cursor)?;
        cursor.expect(".")?;
        Ok((addr, cursor.number()?))
    }
}

fn region_named(name: &str) -> Option<Region> {
    Some(match name {
        "state" => Region::State,
        "I" => Region::I,
        "Q" => Region::Q,
        "M" => Region::M,
        "system" => Region::System,
        "cells" => Region::Cells,
        "L" => Region::L,
        "V" => Region::V,
        "anydb" => Region::AnyDb,
        "any" => Region::Any,
        _ => Region::Db(name.strip_prefix("DB")?.parse().ok()?),
    })
}
