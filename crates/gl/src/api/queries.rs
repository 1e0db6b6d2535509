//! Occlusion queries.

use super::arguments::read;
use crate::{Context, enums as gl};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// `SAMPLES_PASSED` counts, `ANY_SAMPLES_PASSED` tells whether there are any
/// (ARB_occlusion_query2).
const TARGETS: [u32; 2] = [gl::SAMPLES_PASSED, gl::ANY_SAMPLES_PASSED];

/// What a query asks, and what pending draws count into.
#[derive(Clone, Debug)]
struct Query {
    target: u32,
    counter: Arc<AtomicU64>,
}

/// Query objects. Other than textures and buffers they are never shared.
#[derive(Debug, Default)]
pub(crate) struct Queries {
    /// Names in use; `None` until the first `BeginQuery`.
    names: BTreeMap<u32, Option<Query>>,
    /// Name of the active query, and itself.
    active: Option<(u32, Query)>,
}

impl Queries {
    /// The counter of samples, while a query is active.
    pub(crate) fn active(&self) -> Option<Arc<AtomicU64>> {
        self.active.as_ref().map(|(_, query)| query.counter.clone())
    }

    /// Whether `name` is a query object.
    pub(crate) fn is_object(&self, name: u32) -> bool {
        matches!(self.names.get(&name), Some(Some(_)))
    }

    /// The target of an object.
    fn target(&self, name: u32) -> Option<u32> {
        self.names.get(&name)?.as_ref().map(|query| query.target)
    }

    fn active_name(&self) -> u32 {
        self.active.as_ref().map_or(0, |(name, _)| *name)
    }
}

impl Context {
    /// `glGenQueries`.
    pub fn gen_queries(&mut self, n: i32, ids: usize) {
        let call = "glGenQueries";
        if !self.may_set(call) {
            return;
        }
        if n < 0 {
            return self.refuse_value(call, "the number of names is negative");
        }
        let mut name = self.shared.names.first();
        for i in 0..n as usize {
            while self.queries.names.contains_key(&name) {
                name = name.wrapping_add(1).max(1);
            }
            let at = ids.checked_add(i * 4).filter(|_| ids != 0);
            if !at.is_some_and(|at| self.memory.write(at, bytemuck::bytes_of(&name))) {
                return self.refuse_value(call, "the names have no writable memory");
            }
            self.queries.names.insert(name, None);
        }
    }

    /// `glDeleteQueries`. An active query ends.
    pub fn delete_queries(&mut self, n: i32, ids: usize) {
        let call = "glDeleteQueries";
        if !self.may_set(call) {
            return;
        }
        if n < 0 {
            return self.refuse_value(call, "the number of names is negative");
        }
        for i in 0..n as usize {
            let name = ids.checked_add(i * 4).and_then(|at| read::<u32, 1>(&*self.memory, at, 1));
            let Some([name]) = name else {
                return self.refuse_value(call, "the names are not in readable memory");
            };
            if name != 0 && self.queries.active_name() == name {
                self.queries.active = None;
            }
            if self.queries.names.remove(&name).is_some() {
                self.forget_label(gl::QUERY, name);
            }
        }
    }

    /// `glIsQuery`.
    pub fn is_query(&mut self, id: u32) -> u8 {
        u8::from(self.may_set("glIsQuery") && self.queries.is_object(id))
    }

    /// `glBeginQuery`.
    pub fn begin_query(&mut self, target: u32, id: u32) {
        self.listable(move |c| {
            let call = "glBeginQuery";
            if !c.may_set(call) || !c.check_enum(call, "target", target, &TARGETS) {
            } else if id == 0 {
                c.refuse_operation(call, "0 is not a query object");
            } else if c.queries.active.is_some() {
                c.refuse_operation(call, "a query is active");
            } else if c.queries.target(id).is_some_and(|t| t != target) {
                c.refuse_operation(call, "the query object is of another target");
            } else {
                let query = Query { target, counter: Arc::default() };
                c.queries.names.insert(id, Some(query.clone()));
                c.queries.active = Some((id, query));
            }
        });
    }

    /// `glEndQuery`.
    pub fn end_query(&mut self, target: u32) {
        self.listable(move |c| {
            let call = "glEndQuery";
            if !c.may_set(call) || !c.check_enum(call, "target", target, &TARGETS) {
            } else if c.queries.active.take_if(|(_, query)| query.target == target).is_none() {
                c.refuse_operation(call, "no query of this target is active");
            }
        });
    }

    /// `glGetQueryiv`.
    pub fn get_queryiv(&mut self, target: u32, pname: u32, params: usize) {
        let call = "glGetQueryiv";
        if !self.may_set(call) || !self.check_enum(call, "target", target, &TARGETS) {
            return;
        }
        let value = match pname {
            gl::CURRENT_QUERY => {
                let of_target =
                    self.queries.active.as_ref().filter(|(_, query)| query.target == target);
                of_target.map_or(0, |(name, _)| *name)
            }
            gl::QUERY_COUNTER_BITS if target == gl::ANY_SAMPLES_PASSED => 1,
            gl::QUERY_COUNTER_BITS => 32,
            _ => return self.refuse_enum(call, "pname", pname),
        };
        self.give_results(call, params, &[value]);
    }

    /// The result, as far as `limit` reaches, or 1 for its availability: asking finishes what is
    /// pending.
    fn query_value(&mut self, call: &str, id: u32, pname: u32, limit: u32) -> Option<u32> {
        if !self.may_set(call) {
            return None;
        }
        let query = self.queries.names.get(&id).cloned().flatten();
        let Some(query) = query.filter(|_| self.queries.active_name() != id) else {
            self.refuse_operation(call, "no query object of that name, or it is active");
            return None;
        };
        if !self.check_enum(call, "pname", pname, &[gl::QUERY_RESULT, gl::QUERY_RESULT_AVAILABLE]) {
            return None;
        }
        self.flush_recorded();
        let limit = if query.target == gl::ANY_SAMPLES_PASSED { 1 } else { limit };
        let samples = query.counter.load(Ordering::Relaxed).min(limit.into()) as u32;
        Some(if pname == gl::QUERY_RESULT { samples } else { 1 })
    }

    /// `glGetQueryObjectiv`.
    pub fn get_query_objectiv(&mut self, id: u32, pname: u32, params: usize) {
        let call = "glGetQueryObjectiv";
        if let Some(value) = self.query_value(call, id, pname, i32::MAX as u32) {
            self.give_results(call, params, &[value]);
        }
    }

    /// `glGetQueryObjectuiv`.
    pub fn get_query_objectuiv(&mut self, id: u32, pname: u32, params: usize) {
        let call = "glGetQueryObjectuiv";
        if let Some(value) = self.query_value(call, id, pname, u32::MAX) {
            self.give_results(call, params, &[value]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::testing::{RESULT, context, put, take};

    #[test]
    fn a_query_lives() {
        let mut c = context();
        c.gen_queries(2, RESULT);
        assert_eq!(take::<u32, 2>(&c), [1, 2]);
        assert_eq!(c.is_query(1), 0);
        c.begin_query(gl::SAMPLES_PASSED, 1);
        assert_eq!(c.is_query(1), 1);
        c.queries.active().unwrap().fetch_add(5_000_000_000, Ordering::Relaxed);
        c.get_queryiv(gl::SAMPLES_PASSED, gl::CURRENT_QUERY, RESULT);
        assert_eq!(take::<u32, 1>(&c), [1]);
        c.get_query_objectuiv(1, gl::QUERY_RESULT, RESULT);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.end_query(gl::SAMPLES_PASSED);
        assert!(c.queries.active().is_none());
        c.get_query_objectuiv(1, gl::QUERY_RESULT, RESULT);
        assert_eq!(take::<u32, 1>(&c), [u32::MAX]);
        c.get_query_objectiv(1, gl::QUERY_RESULT, RESULT);
        assert_eq!(take::<i32, 1>(&c), [i32::MAX]);
        let at = put(&c, &[1_u32, 0, 77]);
        c.delete_queries(3, at);
        assert_eq!((c.is_query(1), c.get_error()), (0, gl::NO_ERROR));
        c.gen_queries(2, RESULT);
        assert_eq!(take::<u32, 2>(&c), [1, 3]);
    }

    #[test]
    fn any_samples_are_one() {
        let mut c = context();
        c.begin_query(gl::ANY_SAMPLES_PASSED, 1);
        c.queries.active().unwrap().fetch_add(5, Ordering::Relaxed);
        c.end_query(gl::SAMPLES_PASSED);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.end_query(gl::ANY_SAMPLES_PASSED);
        c.get_query_objectuiv(1, gl::QUERY_RESULT, RESULT);
        assert_eq!((take::<u32, 1>(&c), c.get_error()), ([1], gl::NO_ERROR));
        c.begin_query(gl::SAMPLES_PASSED, 1);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
    }

    #[test]
    fn errors() {
        let mut c = context();
        c.end_query(gl::SAMPLES_PASSED);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.begin_query(gl::SAMPLES_PASSED, 0);
        assert_eq!(c.get_error(), gl::INVALID_OPERATION);
        c.begin_query(gl::TEXTURE_2D, 1);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.begin_query(gl::SAMPLES_PASSED, 9);
        c.begin_query(gl::SAMPLES_PASSED, 10);
        assert_eq!((c.get_error(), c.is_query(10)), (gl::INVALID_OPERATION, 0));
        c.end_query(gl::SAMPLES_PASSED);
        c.get_query_objectiv(9, gl::CURRENT_QUERY, RESULT);
        assert_eq!(c.get_error(), gl::INVALID_ENUM);
        c.gen_queries(-1, RESULT);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
        c.gen_queries(i32::MAX, usize::MAX - 8);
        assert_eq!(c.get_error(), gl::INVALID_VALUE);
    }
}
