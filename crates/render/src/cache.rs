//! What algorithms keep between frames: a cache with one slot for each type.
//!
//! A session makes many frames of one scene, and much of what an algorithm computes depends on the
//! scene or its lights alone: trees over the triangles, shadow maps, a radiosity solution. An
//! algorithm keeps such a value in the session's [`Cache`]. It implements [`Cached`] for the type,
//! in its own file, and says with which key the value was built; a value whose key differs from the
//! one asked for is dropped and built anew. The cache knows no algorithm: slots are found by type.
//!
//! Cost: a lookup takes two locks and a hash of the type. While a value is built its slot stays
//! locked, so that two threads never build the same one; a build may look other types up.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock};

/// A value that outlives a frame.
pub trait Cached: Any + Send + Sync {
    /// What the value depends on besides the scene, which never changes within a session.
    type Key: PartialEq + Send + Sync + 'static;

    /// How long the value serves.
    const REUSE: Reuse = Reuse::Scene;

    /// Whether the value depends on where instances are. Such values are dropped when instances
    /// move.
    const PLACED: bool = true;

    /// How many reusable results the value holds, for the statistics: 1 unless it gathers results
    /// of many meshes.
    fn results(&self) -> usize {
        1
    }
}

/// How long a cached value serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reuse {
    /// For the frames of a scene. Dropped without frame coherence, and counted in
    /// [`Stats::reused`](crate::Stats::reused).
    Scene,
    /// For frames from one viewpoint. Dropped without frame coherence, but not counted: a moving
    /// camera never meets it twice.
    View,
    /// Whether or not frames are coherent: solutions that are asked for by name, and memory to
    /// reuse.
    Session,
}

/// See the module.
#[derive(Default)]
pub struct Cache {
    slots: Mutex<HashMap<TypeId, Arc<dyn AnySlot>>>,
}

/// The value of one type, with the key that it was built with.
type Slot<T> = Mutex<Option<(<T as Cached>::Key, Arc<T>)>>;

/// A slot whose type is not known.
trait AnySlot: Any + Send + Sync {
    fn reuse(&self) -> Reuse;
    fn is_placed(&self) -> bool;
    fn has_key(&self) -> bool;
    fn results(&self) -> usize;
    fn clear(&self);
}

/// What a lock's `expect` says: a build that panics takes the frame with it.
const UNPOISONED: &str = "no thread panics while it builds a cached value";

impl<T: Cached> AnySlot for Slot<T> {
    fn reuse(&self) -> Reuse {
        T::REUSE
    }

    fn is_placed(&self) -> bool {
        T::PLACED
    }

    fn has_key(&self) -> bool {
        TypeId::of::<T::Key>() != TypeId::of::<()>()
    }

    fn results(&self) -> usize {
        self.lock()
            .ok()
            .and_then(|slot| slot.as_ref().map(|(_, value)| value.results()))
            .unwrap_or(0)
    }

    fn clear(&self) {
        *self.lock().expect(UNPOISONED) = None;
    }
}

impl Cache {
    /// The value for `key`: the cached one, or the one that `build` makes, which is cached from
    /// then on. A value with another key is dropped first, so that both never take memory at a
    /// time.
    ///
    /// # Errors
    /// That of `build`; nothing is cached then.
    pub fn get_or_build<T: Cached, E>(
        &self,
        key: T::Key,
        build: impl FnOnce() -> Result<T, E>,
    ) -> Result<Arc<T>, E> {
        let slot = self.slot::<T>();
        let mut slot = lock::<T>(&slot);
        if let Some((known, value)) = &*slot
            && *known == key
        {
            return Ok(Arc::clone(value));
        }
        *slot = None;
        let value = Arc::new(build()?);
        *slot = Some((key, Arc::clone(&value)));
        Ok(value)
    }

    /// The cached value, whatever its key.
    pub fn get<T: Cached>(&self) -> Option<Arc<T>> {
        lock::<T>(&self.slot::<T>()).as_ref().map(|(_, value)| Arc::clone(value))
    }

    /// Caches a value that was not built here.
    pub fn insert<T: Cached>(&self, key: T::Key, value: Arc<T>) {
        *lock::<T>(&self.slot::<T>()) = Some((key, value));
    }

    /// Takes the value out if its key is not `key`, so that its memory can be reused.
    pub fn take_outdated<T: Cached>(&self, key: &T::Key) -> Option<Arc<T>> {
        lock::<T>(&self.slot::<T>()).take_if(|(known, _)| known != key).map(|(_, value)| value)
    }

    /// Drops what serves coherent frames only; a value that serves the whole session stays.
    pub fn forget_frames(&self) {
        self.each(|slot| {
            if slot.reuse() != Reuse::Session {
                slot.clear();
            }
        });
    }

    /// A cache of another session of the same scene. Both share what depends on the scene alone and
    /// is already cached: it is the same for both, however lights and cameras differ.
    pub(crate) fn fork(&self) -> Self {
        let slots = self.slots.lock().expect(UNPOISONED);
        let is_shared = |slot: &dyn AnySlot| slot.reuse() == Reuse::Scene && !slot.has_key();
        let shared = slots
            .iter()
            .filter(|(_, slot)| is_shared(&***slot))
            .map(|(id, slot)| (*id, Arc::clone(slot)));
        Self { slots: Mutex::new(shared.collect()) }
    }

    /// Drops what depends on where instances are. Caches that share a slot keep it.
    pub(crate) fn forget_placed(&mut self) {
        self.slots.get_mut().expect(UNPOISONED).retain(|_, slot| !slot.is_placed());
    }

    /// How many results of earlier frames can be reused.
    pub fn results(&self) -> usize {
        let mut results = 0;
        self.each(|slot| results += if slot.reuse() == Reuse::Scene { slot.results() } else { 0 });
        results
    }

    /// The slot of a type, made on first use.
    fn slot<T: Cached>(&self) -> Arc<dyn AnySlot> {
        let mut slots = self.slots.lock().expect(UNPOISONED);
        Arc::clone(slots.entry(TypeId::of::<T>()).or_insert_with(|| Arc::new(Slot::<T>::default())))
    }

    fn each(&self, mut visit: impl FnMut(&dyn AnySlot)) {
        let slots: Vec<_> = self.slots.lock().expect(UNPOISONED).values().cloned().collect();
        slots.iter().for_each(|slot| visit(&**slot));
    }
}

/// Locks the slot of type `T`.
fn lock<T: Cached>(slot: &Arc<dyn AnySlot>) -> MutexGuard<'_, Option<(T::Key, Arc<T>)>> {
    let slot: &dyn Any = &**slot;
    slot.downcast_ref::<Slot<T>>().expect("slots are found by their type").lock().expect(UNPOISONED)
}

/// Values that belong to one mesh each, built when first needed.
#[derive(Debug)]
pub struct PerMesh<T>(Vec<OnceLock<T>>);

impl<T: Any + Send + Sync> Cached for PerMesh<T> {
    type Key = ();
    const PLACED: bool = false;

    fn results(&self) -> usize {
        self.0.iter().filter(|value| value.get().is_some()).count()
    }
}

impl<T> PerMesh<T> {
    /// Room for the values of `meshes` meshes.
    pub(crate) fn new(meshes: usize) -> Self {
        Self((0..meshes).map(|_| OnceLock::new()).collect())
    }

    /// The value of a mesh: the cached one, or the one that `build` makes.
    pub fn get_or_build(&self, mesh: u32, build: impl FnOnce() -> T) -> &T {
        self.0[mesh as usize].get_or_init(build)
    }
}

impl std::fmt::Debug for Cache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Cache").field("results", &self.results()).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[derive(Debug, PartialEq)]
    struct Tree(u32);

    impl Cached for Tree {
        type Key = u32;
    }

    struct Solved;

    impl Cached for Solved {
        type Key = ();
        const REUSE: Reuse = Reuse::Session;
    }

    fn tree(cache: &Cache, key: u32) -> Arc<Tree> {
        cache.get_or_build(key, || Ok::<_, Infallible>(Tree(key))).unwrap()
    }

    #[test]
    fn a_value_is_built_once_for_each_key() {
        let cache = Cache::default();
        let first = tree(&cache, 1);
        assert!(Arc::ptr_eq(&first, &tree(&cache, 1)), "the same key finds the same value");
        assert_eq!(*tree(&cache, 2), Tree(2));
        assert!(!Arc::ptr_eq(&first, &tree(&cache, 1)), "only the last key is kept");
    }

    #[test]
    fn a_build_that_fails_leaves_nothing() {
        let cache = Cache::default();
        tree(&cache, 1);
        assert_eq!(cache.get_or_build::<Tree, _>(2, || Err("limit")).unwrap_err(), "limit");
        assert_eq!(cache.get::<Tree>(), None);
    }

    #[test]
    fn a_build_may_look_other_types_up() {
        let cache = Cache::default();
        let build = || {
            tree(&cache, 7);
            Ok::<_, Infallible>(Solved)
        };
        cache.get_or_build((), build).unwrap();
        assert_eq!(cache.get::<Tree>().map(|tree| tree.0), Some(7));
    }

    #[test]
    fn forgetting_frames_spares_what_serves_the_session() {
        let cache = Cache::default();
        tree(&cache, 1);
        cache.insert((), Arc::new(Solved));
        assert_eq!(cache.results(), 1, "a solution is asked for by name, and does not count");
        cache.forget_frames();
        assert_eq!((cache.results(), cache.get::<Tree>()), (0, None));
        assert!(cache.get::<Solved>().is_some());
    }

    #[test]
    fn a_fork_shares_what_depends_on_the_scene_alone() {
        let mut cache = Cache::default();
        tree(&cache, 1);
        cache.insert((), Arc::new(Solved));
        let of_meshes = || Ok::<_, Infallible>(PerMesh::<u8>::new(3));
        let Ok(known) = cache.get_or_build((), of_meshes);
        let fork = cache.fork();
        assert!(
            fork.get::<Tree>().is_none() && fork.get::<Solved>().is_none(),
            "a key, and memory"
        );
        assert!(Arc::ptr_eq(&known, &fork.get::<PerMesh<u8>>().unwrap()));
        // What is known of meshes stays when they move.
        cache.forget_placed();
        assert!(cache.get::<Tree>().is_none() && cache.get::<PerMesh<u8>>().is_some());
    }

    #[test]
    fn an_outdated_value_is_handed_out() {
        let cache = Cache::default();
        tree(&cache, 1);
        assert!(cache.take_outdated::<Tree>(&1).is_none());
        assert_eq!(cache.take_outdated::<Tree>(&2).map(|tree| tree.0), Some(1));
        assert!(cache.get::<Tree>().is_none());
    }
}
