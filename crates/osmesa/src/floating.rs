//! The floating-point environment: what computes runs in the default one, so that its bytes are the
//! same whatever rounding mode, traps or flushing of small numbers the program has set. The
//! program's own comes back with the call's end. Threads inherit the environment of the thread that
//! makes them, which is such a call.

/// The control word of the thread: rounding, traps, small numbers. Bits that only tell what has
/// happened are left out.
#[cfg(all(target_arch = "x86_64", not(miri)))]
mod control {
    use std::arch::asm;

    /// Nearest, no traps, nothing flushed.
    const DEFAULT: u32 = 0x1f80;
    /// What has happened.
    const FLAGS: u32 = 0x3f;

    #[inline(always)]
    pub(super) fn unusual() -> Option<u32> {
        let mut word = 0_u32;
        // SAFETY: stores the control word in a variable of its size.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags)) };
        (word & !FLAGS != DEFAULT).then_some(word)
    }

    pub(super) fn set_default() {
        set(DEFAULT);
    }

    pub(super) fn set(word: u32) {
        // SAFETY: the word is the default, or was read from the register.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, preserves_flags)) };
    }
}

#[cfg(all(target_arch = "aarch64", not(miri)))]
mod control {
    use std::arch::asm;

    #[inline(always)]
    pub(super) fn unusual() -> Option<u64> {
        let word: u64;
        // SAFETY: reads a register that every program may read.
        unsafe { asm!("mrs {}, fpcr", out(reg) word, options(nostack, preserves_flags)) };
        (word != 0).then_some(word)
    }

    pub(super) fn set_default() {
        set(0);
    }

    pub(super) fn set(word: u64) {
        // SAFETY: the word is the default, or was read from the register.
        unsafe { asm!("msr fpcr, {}", in(reg) word, options(nostack, preserves_flags)) };
    }
}

#[cfg(any(miri, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
mod control {
    pub(super) fn unusual() -> Option<u32> {
        None
    }

    pub(super) fn set_default() {}

    pub(super) fn set(_word: u32) {}
}

/// Runs `body`, which must not unwind, in the default environment.
#[inline(always)]
pub(crate) fn in_default_environment<R>(body: impl FnOnce() -> R) -> R {
    let unusual = control::unusual();
    if unusual.is_some() {
        control::set_default();
    }
    let result = body();
    if let Some(word) = unusual {
        control::set(word);
    }
    result
}

#[cfg(all(test, target_arch = "x86_64", not(miri)))]
mod tests {
    use super::*;
    use std::hint::black_box;

    #[test]
    fn what_computes_rounds_to_nearest_and_the_callers_mode_comes_back() {
        let third = || black_box(1.0_f32) / black_box(3.0);
        let nearest = third();
        // Towards zero, and a trap for division by zero.
        control::set(0x1f80 | 0x6000);
        let (below, inside) = (third(), in_default_environment(third));
        control::set(0x1f80 & !0x0200);
        let infinite = in_default_environment(|| black_box(1.0_f32) / black_box(0.0));
        let kept = control::unusual();
        control::set_default();
        assert!(below < nearest && inside == nearest && infinite.is_infinite());
        assert_eq!((kept.map(|word| word & 0x0200), control::unusual()), (Some(0), None));
    }
}
