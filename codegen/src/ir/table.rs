//! Tables of numbers, computed when they are first read: text is emitted without them.

use std::fmt;
use std::ops::Deref;
use std::sync::{Arc, OnceLock, Weak};

/// A table of numbers that [`super::Inst::Load`] reads.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// A readable name, unique in the module.
    pub name: String,
    /// The numbers; at least one.
    pub data: Numbers,
}

/// Numbers that may not have been computed yet; their count is known. Clones share them.
#[derive(Clone)]
pub struct Numbers {
    len: usize,
    shared: Arc<Shared>,
}

/// Numbers that are there as long as something else has them.
#[derive(Clone)]
pub(crate) struct Borrowed {
    len: usize,
    shared: Weak<Shared>,
}

impl Borrowed {
    pub(crate) fn get(&self) -> Option<Numbers> {
        let shared = self.shared.upgrade()?;
        Some(Numbers {
            len: self.len,
            shared,
        })
    }
}

struct Shared {
    data: OnceLock<Vec<f32>>,
    compute: Option<Box<dyn Fn() -> Vec<f32> + Send + Sync>>,
    /// Measures the largest error of what is read from the numbers.
    measure: Option<Measure>,
    error: OnceLock<f64>,
}

type Measure = Box<dyn Fn(&[f32]) -> f64 + Send + Sync>;

impl Numbers {
    /// `len` numbers that `compute` gives when they are first read.
    pub fn lazy(len: usize, compute: impl Fn() -> Vec<f32> + Send + Sync + 'static) -> Self {
        let compute: Box<dyn Fn() -> Vec<f32> + Send + Sync> = Box::new(compute);
        let shared = Shared {
            data: OnceLock::new(),
            compute: Some(compute),
            measure: None,
            error: OnceLock::new(),
        };
        Self {
            len,
            shared: Arc::new(shared),
        }
    }

    /// The same numbers, whose [`Self::error`] this function of them measures.
    ///
    /// # Panics
    /// If the numbers have been cloned: a bug of the caller.
    pub fn with_error(self, measure: impl Fn(&[f32]) -> f64 + Send + Sync + 'static) -> Self {
        let mut shared = Arc::into_inner(self.shared).expect("new numbers are not shared");
        shared.measure = Some(Box::new(measure));
        Self {
            len: self.len,
            shared: Arc::new(shared),
        }
    }

    /// The largest error of what is read from the numbers, in the units of what they stand for;
    /// `None` where they are exact. Computes the numbers, and measures when first asked.
    pub fn error(&self) -> Option<f64> {
        let measure = self.shared.measure.as_ref()?;
        Some(*self.shared.error.get_or_init(|| measure(self)))
    }

    /// The same numbers, which this does not keep.
    pub(crate) fn borrowed(&self) -> Borrowed {
        Borrowed {
            len: self.len,
            shared: Arc::downgrade(&self.shared),
        }
    }

    /// Whether they are the same numbers in the same place, so that reading the one reads the other;
    /// computes none.
    pub fn is_shared_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    /// Whether they have been computed.
    pub fn is_computed(&self) -> bool {
        self.shared.data.get().is_some()
    }

    /// How many numbers; computes none.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl From<Vec<f32>> for Numbers {
    fn from(data: Vec<f32>) -> Self {
        let len = data.len();
        Self {
            len,
            shared: Arc::new(Shared {
                data: OnceLock::from(data),
                compute: None,
                measure: None,
                error: OnceLock::new(),
            }),
        }
    }
}

impl Deref for Numbers {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        self.shared.data.get_or_init(|| {
            let data = self
                .shared
                .compute
                .as_ref()
                .map(|compute| compute())
                .unwrap_or_default();
            assert_eq!(data.len(), self.len, "numbers of a table");
            data
        })
    }
}

impl PartialEq for Numbers {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared) || **self == **other
    }
}

impl fmt::Debug for Numbers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shared.data.get() {
            Some(data) => data.fmt(f),
            None => write!(f, "{} numbers to come", self.len),
        }
    }
}
