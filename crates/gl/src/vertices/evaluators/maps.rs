//! Maps and grids: setting and asking.

use super::evaluate::COMPONENTS;
use crate::state::{MAX_EVAL_ORDER, Map1, Map2};
use crate::vertices::client::{self, Component};
use crate::{Context, enums};
use std::ops::Range;

type Trouble = (u32, &'static str);

/// Which map a target is, counted from `first`.
fn map_index(target: u32, first: u32) -> Result<usize, Trouble> {
    let index = target.wrapping_sub(first) as usize;
    if index < COMPONENTS.len() {
        Ok(index)
    } else {
        Err((enums::INVALID_ENUM, "target is not a map"))
    }
}

/// Checks a stride and an order.
fn checked(stride: i32, order: i32, components: usize) -> Result<(usize, usize), Trouble> {
    match usize::try_from(order) {
        Ok(order @ 1..=MAX_EVAL_ORDER) if stride >= components as i32 => {
            Ok((stride as usize, order))
        }
        Ok(1..=MAX_EVAL_ORDER) => {
            Err((enums::INVALID_VALUE, "stride is less than a control point"))
        }
        _ => Err((enums::INVALID_VALUE, "order is less than 1 or more than the maximum")),
    }
}

const EMPTY_DOMAIN: Trouble = (enums::INVALID_VALUE, "the domain is empty");

impl Context {
    /// One control point after another, from where `offsets` (in numbers) say.
    fn control_points<T: Component>(
        &self,
        points: usize,
        components: usize,
        offsets: impl Iterator<Item = usize>,
    ) -> Result<Vec<f32>, Trouble> {
        let mut all = Vec::new();
        for offset in offsets {
            let address =
                offset.checked_mul(size_of::<T>()).and_then(|offset| offset.checked_add(points));
            let point =
                address.and_then(|address| client::values::<T>(&*self.memory, address, components));
            let point = if points == 0 { None } else { point };
            let point = point
                .ok_or((enums::INVALID_VALUE, "control points are not in the client's memory"))?;
            all.extend(point.into_iter().map(Component::plain));
        }
        Ok(all)
    }

    fn read_map_1<T: Component>(
        &self,
        target: u32,
        u: [f32; 2],
        (stride, order): (i32, i32),
        points: usize,
    ) -> Result<(usize, Map1), Trouble> {
        let index = map_index(target, enums::MAP1_COLOR_4)?;
        let components = COMPONENTS[index];
        let (stride, order) = checked(stride, order, components)?;
        if u[0] == u[1] {
            return Err(EMPTY_DOMAIN);
        }
        let points =
            self.control_points::<T>(points, components, (0..order).map(|i| i * stride))?;
        Ok((index, Map1 { order, u, points }))
    }

    fn read_map_2<T: Component>(
        &self,
        target: u32,
        (u, ustride, uorder): ([f32; 2], i32, i32),
        (v, vstride, vorder): ([f32; 2], i32, i32),
        points: usize,
    ) -> Result<(usize, Map2), Trouble> {
        let index = map_index(target, enums::MAP2_COLOR_4)?;
        let components = COMPONENTS[index];
        let (ustride, uorder) = checked(ustride, uorder, components)?;
        let (vstride, vorder) = checked(vstride, vorder, components)?;
        if u[0] == u[1] || v[0] == v[1] {
            return Err(EMPTY_DOMAIN);
        }
        let offsets = (0..uorder).flat_map(|i| (0..vorder).map(move |j| i * ustride + j * vstride));
        let points = self.control_points::<T>(points, components, offsets)?;
        Ok((index, Map2 { order: [uorder, vorder], u, v, points }))
    }

    fn store_map<M: Clone + Send + Sync + 'static>(
        &mut self,
        call: &'static str,
        map: Result<(usize, M), Trouble>,
        slot: fn(&mut Self) -> &mut [M; 9],
    ) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) {
                return;
            }
            match &map {
                Err((error, why)) => c.record_error(*error, call, why),
                Ok(_) if c.state.active_unit != 0 => {
                    c.record_error(
                        enums::INVALID_OPERATION,
                        call,
                        "the active texture unit is not 0",
                    );
                }
                Ok((index, map)) => slot(c)[*index] = map.clone(),
            }
        });
    }

    /// `glMap1d`.
    pub fn map_1d(
        &mut self,
        target: u32,
        u1: f64,
        u2: f64,
        stride: i32,
        order: i32,
        points: usize,
    ) {
        let map = self.read_map_1::<f64>(target, [u1 as f32, u2 as f32], (stride, order), points);
        self.store_map("glMap1d", map, |c| &mut c.state.eval.map1);
    }

    /// `glMap1f`.
    pub fn map_1f(
        &mut self,
        target: u32,
        u1: f32,
        u2: f32,
        stride: i32,
        order: i32,
        points: usize,
    ) {
        let map = self.read_map_1::<f32>(target, [u1, u2], (stride, order), points);
        self.store_map("glMap1f", map, |c| &mut c.state.eval.map1);
    }

    /// `glMap2d`.
    pub fn map_2d(
        &mut self,
        target: u32,
        u1: f64,
        u2: f64,
        ustride: i32,
        uorder: i32,
        v1: f64,
        v2: f64,
        vstride: i32,
        vorder: i32,
        points: usize,
    ) {
        let (u, v) = ([u1 as f32, u2 as f32], [v1 as f32, v2 as f32]);
        let map =
            self.read_map_2::<f64>(target, (u, ustride, uorder), (v, vstride, vorder), points);
        self.store_map("glMap2d", map, |c| &mut c.state.eval.map2);
    }

    /// `glMap2f`.
    pub fn map_2f(
        &mut self,
        target: u32,
        u1: f32,
        u2: f32,
        ustride: i32,
        uorder: i32,
        v1: f32,
        v2: f32,
        vstride: i32,
        vorder: i32,
        points: usize,
    ) {
        let map = self.read_map_2::<f32>(
            target,
            ([u1, u2], ustride, uorder),
            ([v1, v2], vstride, vorder),
            points,
        );
        self.store_map("glMap2f", map, |c| &mut c.state.eval.map2);
    }

    fn set_grid_1(&mut self, call: &'static str, un: i32, u: [f32; 2]) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) {
            } else if un < 1 {
                c.record_error(enums::INVALID_VALUE, call, "a grid has at least one segment");
            } else {
                c.state.eval.grid1 = (un, u);
            }
        });
    }

    fn set_grid_2(&mut self, call: &'static str, n: [i32; 2], u: [f32; 2], v: [f32; 2]) {
        self.listable(move |c| {
            if c.refused_inside_begin(call) {
            } else if n[0] < 1 || n[1] < 1 {
                c.record_error(enums::INVALID_VALUE, call, "a grid has at least one segment");
            } else {
                c.state.eval.grid2 = (n, u, v);
            }
        });
    }

    /// `glMapGrid1d`.
    pub fn map_grid_1d(&mut self, un: i32, u1: f64, u2: f64) {
        self.set_grid_1("glMapGrid1d", un, [u1 as f32, u2 as f32]);
    }

    /// `glMapGrid1f`.
    pub fn map_grid_1f(&mut self, un: i32, u1: f32, u2: f32) {
        self.set_grid_1("glMapGrid1f", un, [u1, u2]);
    }

    /// `glMapGrid2d`.
    pub fn map_grid_2d(&mut self, un: i32, u1: f64, u2: f64, vn: i32, v1: f64, v2: f64) {
        self.set_grid_2("glMapGrid2d", [un, vn], [u1 as f32, u2 as f32], [v1 as f32, v2 as f32]);
    }

    /// `glMapGrid2f`.
    pub fn map_grid_2f(&mut self, un: i32, u1: f32, u2: f32, vn: i32, v1: f32, v2: f32) {
        self.set_grid_2("glMapGrid2f", [un, vn], [u1, u2], [v1, v2]);
    }

    /// What `GetMap` tells.
    fn map_values(&self, target: u32, query: u32) -> Result<Vec<f32>, Trouble> {
        const MAPS_2: Range<u32> = enums::MAP2_COLOR_4..enums::MAP2_COLOR_4 + 9;
        let eval = &self.state.eval;
        let (order, domain, points) = if MAPS_2.contains(&target) {
            let map = &eval.map2[map_index(target, enums::MAP2_COLOR_4)?];
            (map.order.to_vec(), [map.u, map.v].concat(), &map.points)
        } else {
            let map = &eval.map1[map_index(target, enums::MAP1_COLOR_4)?];
            (vec![map.order], map.u.to_vec(), &map.points)
        };
        match query {
            enums::COEFF => Ok(points.clone()),
            enums::ORDER => Ok(order.into_iter().map(|n| n as f32).collect()),
            enums::DOMAIN => Ok(domain),
            _ => Err((enums::INVALID_ENUM, "query is not one of maps")),
        }
    }

    fn give_map<T: bytemuck::Pod>(
        &mut self,
        call: &str,
        target: u32,
        query: u32,
        to: usize,
        convert: fn(f32) -> T,
    ) {
        if self.refused_inside_begin(call) {
            return;
        }
        match self.map_values(target, query) {
            Err((error, why)) => self.record_error(error, call, why),
            Ok(values) => {
                let values: Vec<T> = values.into_iter().map(convert).collect();
                if to == 0 || !self.memory.write(to, bytemuck::cast_slice(&values)) {
                    self.record_error(enums::INVALID_VALUE, call, "values cannot be written there");
                }
            }
        }
    }

    /// `glGetMapdv`.
    pub fn get_mapdv(&mut self, target: u32, query: u32, v: usize) {
        self.give_map("glGetMapdv", target, query, v, f64::from);
    }

    /// `glGetMapfv`.
    pub fn get_mapfv(&mut self, target: u32, query: u32, v: usize) {
        self.give_map("glGetMapfv", target, query, v, |x| x);
    }

    /// `glGetMapiv`.
    pub fn get_mapiv(&mut self, target: u32, query: u32, v: usize) {
        self.give_map("glGetMapiv", target, query, v, |x| x.round() as i32);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::tests::{BASE, context};
    use super::*;

    #[test]
    fn a_map_is_read_with_strides_and_told() {
        let mut c = context();
        let numbers: Vec<f32> = (0..24).map(|i| i as f32).collect();
        c.memory.write(BASE, bytemuck::cast_slice(&numbers));
        // v runs along 3 columns of 4 numbers, of which 2 are used; u along 2 rows.
        c.map_2f(enums::MAP2_TEXTURE_COORD_2, 0.0, 1.0, 12, 2, -1.0, 1.0, 4, 3, BASE);
        c.get_mapiv(enums::MAP2_TEXTURE_COORD_2, enums::COEFF, BASE + 400);
        let told = client::values::<i32>(&*c.memory, BASE + 400, 12).unwrap();
        assert_eq!(told, [0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21]);
        c.get_mapdv(enums::MAP2_TEXTURE_COORD_2, enums::DOMAIN, BASE + 400);
        assert_eq!(
            client::values::<f64>(&*c.memory, BASE + 400, 4).unwrap(),
            [0.0, 1.0, -1.0, 1.0]
        );
        assert_eq!(c.error, 0);
    }

    #[test]
    fn wrong_maps_change_nothing() {
        let mut c = context();
        let before = c.state.eval.clone();
        for (target, u2, stride, order, error) in [
            (enums::MAP1_VERTEX_3, 0.0, 3, 2, enums::INVALID_VALUE),
            (enums::MAP1_VERTEX_3, 1.0, 2, 2, enums::INVALID_VALUE),
            (enums::MAP1_VERTEX_3, 1.0, 3, 31, enums::INVALID_VALUE),
            (enums::MAP1_VERTEX_3, 1.0, i32::MAX, 30, enums::INVALID_VALUE),
            (enums::MAP2_VERTEX_3, 1.0, 3, 2, enums::INVALID_ENUM),
        ] {
            c.map_1d(target, 0.0, u2, stride, order, BASE);
            assert_eq!(std::mem::take(&mut c.error), error);
        }
        c.map_grid_1f(0, 0.0, 1.0);
        assert_eq!(c.error, enums::INVALID_VALUE);
        assert_eq!(c.state.eval, before);
    }
}
