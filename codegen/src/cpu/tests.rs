//! The evaluator against an interpreter of single values, written from the IR's documentation.

use super::*;
use crate::ir::{
    Builder, FunctionId, FunctionRef, Inst, Interface, Op, Scalar, Value, for_each_op,
};
use proptest::prelude::*;

#[derive(Clone, Copy, Debug)]
enum Number<F> {
    Float(F),
    Word(u32),
}

impl<F: Float> Number<F> {
    fn float(self) -> F {
        match self {
            Self::Float(x) => x,
            Self::Word(x) => panic!("{x} is not a real number"),
        }
    }

    fn word(self) -> u32 {
        match self {
            Self::Word(x) => x,
            Self::Float(x) => panic!("{x:?} is not a word"),
        }
    }
}

macro_rules! operand {
    (F, $n:expr) => {
        $n.float()
    };
    (i32, $n:expr) => {
        $n.word() as i32
    };
    (u32, $n:expr) => {
        $n.word()
    };
    (bool, $n:expr) => {
        $n.word() != 0
    };
}

macro_rules! number {
    (F, $e:expr) => {
        Number::Float($e)
    };
    ($t:tt, $e:expr) => {
        Number::Word($e as u32)
    };
}

macro_rules! define_apply {
    ($($variant:ident $name:literal ($($p:ident: $pt:tt),*) -> $rt:tt { $cpu:expr } $wgsl:literal $error:literal $doc:literal;)*) => {
        fn apply<F: Float>(op: Op, operands: &[Number<F>]) -> Number<F> {
            let mut operands = operands.iter();
            match op {
                $(Op::$variant => {
                    $(let $p = operand!($pt, operands.next().unwrap());)*
                    let result: $rt = $cpu;
                    number!($rt, result)
                })*
            }
        }
    };
}
for_each_op!(define_apply);

/// The results of a function for single arguments.
fn interpret<F: Float>(module: &Module, id: FunctionId, arguments: &[Number<F>]) -> Vec<Number<F>> {
    let function = module.function(id);
    let mut values: Vec<Vec<Number<F>>> = Vec::new();
    for inst in &function.insts {
        let get = |v: &Value| values[v.index()][0];
        let all = |vs: &[Value]| vs.iter().map(get).collect::<Vec<_>>();
        values.push(match inst {
            Inst::Const(c) if c.ty == Type::F32 => {
                vec![Number::Float(F::from_f32(f32::from_bits(c.bits)))]
            }
            Inst::Const(c) => vec![Number::Word(c.bits)],
            Inst::Param(i) => vec![arguments[*i as usize]],
            Inst::Op(op, operands) => {
                vec![apply(*op, &all(&operands[..op.info().operands.len()]))]
            }
            Inst::Load(table, index) => {
                let data = &module.tables[*table as usize].data;
                let index = (get(index).word() as usize).min(data.len() - 1);
                vec![Number::Float(F::from_f32(data[index]))]
            }
            Inst::Call(callee, arguments) => interpret(module, *callee, &all(arguments)),
            Inst::Fold {
                function,
                count,
                init,
                captures,
            } => {
                let mut state = all(init);
                for turn in 0..get(count).word() {
                    let mut arguments = vec![Number::Word(turn)];
                    arguments.extend(state.iter().copied().chain(all(captures)));
                    state = interpret(module, *function, &arguments);
                }
                state
            }
            Inst::Result(of, i) => vec![values[of.index()][*i as usize]],
        });
    }
    function
        .results
        .iter()
        .map(|(_, v)| values[v.index()][0])
        .collect()
}

/// Numbers for the parameters of the entry: the bits of one lane after the other.
struct Lanes {
    columns: Vec<(Type, Vec<u32>)>,
}

impl Lanes {
    fn count(&self) -> usize {
        self.columns[0].1.len()
    }

    fn evaluate<F: Float>(
        &self,
        evaluator: &Evaluator<F>,
        scratch: &mut Scratch<F>,
    ) -> Vec<Vec<F>> {
        let floats: Vec<Vec<f32>> = self
            .columns
            .iter()
            .map(|(_, c)| c.iter().map(|&b| f32::from_bits(b)).collect())
            .collect();
        let words: Vec<Vec<i32>> = self
            .columns
            .iter()
            .map(|(_, c)| c.iter().map(|&b| b as i32).collect())
            .collect();
        let inputs: Vec<Input<'_>> = (self.columns.iter().enumerate())
            .map(|(i, (ty, _))| match (*ty, evaluator.is_uniform[i]) {
                (Type::F32, false) => Input::Floats(&floats[i]),
                (Type::F32, true) => Input::Float(floats[i][0]),
                (_, false) => Input::Integers(&words[i]),
                (_, true) => Input::Integer(words[i][0]),
            })
            .collect();
        let mut outputs = Vec::new();
        evaluator.evaluate(scratch, &inputs, self.count(), &mut outputs);
        outputs
    }

    /// The interpreter's results as real numbers, one vector a result.
    fn interpret<F: Float>(&self, module: &Module) -> Vec<Vec<F>> {
        let id = FunctionId::from_index(module.functions.len() - 1);
        let entry = module.entry();
        let mut outputs = vec![Vec::new(); entry.results.len()];
        for lane in 0..self.count() {
            let arguments: Vec<Number<F>> = (self.columns.iter())
                .map(|(ty, column)| match ty {
                    Type::F32 => Number::Float(F::from_f32(f32::from_bits(column[lane]))),
                    _ => Number::Word(column[lane]),
                })
                .collect();
            let results = interpret(module, id, &arguments);
            for ((output, result), (_, value)) in
                outputs.iter_mut().zip(results).zip(&entry.results)
            {
                output.push(match (result, entry.ty(*value)) {
                    (Number::Float(x), _) => x,
                    (Number::Word(x), Type::I32) => F::from_i32(x as i32),
                    (Number::Word(x), _) => F::from_u32(x),
                });
            }
        }
        outputs
    }
}

/// Numbers as bits, all that are not a number alike.
fn bits<F: Float>(numbers: &[Vec<F>]) -> Vec<Vec<u64>> {
    let bits = |x: &F| {
        if x.to_f64().is_nan() {
            u64::MAX
        } else {
            x.to_f64().to_bits()
        }
    };
    numbers
        .iter()
        .map(|column| column.iter().map(bits).collect())
        .collect()
}

fn assert_bank<F: Float>(module: &Module, lanes: &Lanes, uniform: impl Fn(usize) -> bool + Copy) {
    let expected = bits(&lanes.interpret::<F>(module));
    let mut scratch = Scratch::new();
    for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
        let evaluator = Evaluator::<F>::with_uniform(module, uniform).at_level(level);
        let found = bits(&lanes.evaluate(&evaluator, &mut scratch));
        assert_eq!(found, expected, "{level:?}");
    }
}

/// Asserts that every level and both banks agree with the interpreter to the bit.
fn assert_interpreted(module: &Module, lanes: &Lanes, uniform: impl Fn(usize) -> bool + Copy) {
    assert_bank::<f32>(module, lanes, uniform);
    assert_bank::<f64>(module, lanes, uniform);
}

/// Some bits of a type: the edges first, then a walk over all magnitudes.
fn sample(ty: Type, i: u32) -> u32 {
    const EDGES: [f32; 14] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        2.5,
        -2.5,
        1e-40,
        3e9,
        -3e9,
        1e30,
        88.7,
        -103.0,
        f32::MAX,
    ];
    let mixed = (i.wrapping_mul(0x9e37_79b9) ^ (i >> 3)).wrapping_mul(0x85eb_ca6b);
    match ty {
        Type::F32 => match EDGES.get(i as usize) {
            Some(x) => x.to_bits(),
            None if i.is_multiple_of(3) => (mixed as i32 as f32 * 1e-8).to_bits(),
            None => (mixed & 0xbfff_ffff) | 0x0080_0000,
        },
        Type::Bool => mixed >> 31,
        _ => match i {
            0..3 => [0, u32::MAX, 0x8000_0000][i as usize],
            _ if i.is_multiple_of(3) => mixed >> 26,
            _ => mixed,
        },
    }
}

/// A parameter of each type.
fn parameters<'b>(b: &'b Builder, types: &[Type]) -> Vec<Scalar<'b>> {
    let parameters = types.iter().enumerate();
    parameters
        .map(|(i, &ty)| b.scalar_param(format!("p{i}"), ty))
        .collect()
}

#[test]
fn every_op_is_the_interpreters_at_every_level() {
    for &op in Op::ALL {
        let mut module = Module::default();
        let b = &Builder::new("op", "One op.");
        let types = op.info().operands;
        b.result("out", b.dynamic(op, &parameters(b, types)));
        b.finish(&mut module);
        let column = |(i, &ty): (usize, &Type)| {
            let stride = [1, 7, 11][i];
            (
                ty,
                (0..1000)
                    .map(|lane| sample(ty, lane * stride % 331))
                    .collect(),
            )
        };
        let lanes = Lanes {
            columns: types.iter().enumerate().map(column).collect(),
        };
        assert_interpreted(&module, &lanes, |_| false);
    }
}

/// Sums `i · scale + step` for i below each lane's count, and counts the turns in a word.
fn inner_sum(module: &mut Module) -> FunctionRef {
    let b = &Builder::new("inner", "Adds a multiple of the turn.");
    let index = b.uint_param("index");
    let sum = b.float_param("sum");
    let turns = b.uint_param("turns");
    let scale = b.float_param("scale");
    b.result("sum", sum + index.to_float() * scale);
    b.result("turns", turns + 1);
    b.finish(module)
}

/// A fold in a fold whose counts differ by lane. Lanes that have stopped ask for `size − index`
/// turns of the inner fold, which wraps: they must not be heard.
fn nested(module: &mut Module) {
    let inner = inner_sum(module);
    let b = &Builder::new("outer", "Runs the inner sum.");
    let index = b.uint_param("index");
    let [sum, other] = b.float_params(["sum", "other"]);
    let [turns, size] = ["turns", "size"].map(|name| b.uint_param(name));
    let scale = b.float_param("scale");
    let (next, turns) = b.fold(&inner, size - index, (other, turns), scale);
    // The second state becomes what the first was before the turn.
    b.result("sum", next);
    b.result("other", sum);
    b.result("turns", turns);
    let outer = b.finish(module);

    let b = &Builder::new("entry", "Nested folds.");
    let size = b.uint_param("size");
    let scale = b.float_param("scale");
    let start = (scale, b.float(0.0), b.uint(0));
    let (sum, other, turns) = b.fold(&outer, size, start, (size, scale));
    let (again, more) = b.fold(&inner, b.uint(3), (sum, turns), other);
    b.result("r0", sum);
    b.result("r1", other);
    b.result("r2", turns);
    b.result("r3", again);
    b.result("r4", more);
    b.finish(module);
}

#[test]
fn nested_folds_take_each_lanes_own_turns() {
    let mut module = Module::default();
    nested(&mut module);
    let counts: [fn(u32) -> u32; 5] = [
        |lane| lane * 7 % 6,
        |_| 0,
        |_| 4,
        |lane| u32::from(lane == 200),
        |lane| lane / 150,
    ];
    for count in counts {
        let columns = vec![
            (Type::U32, (0..333).map(count).collect()),
            (
                Type::F32,
                (0..333)
                    .map(|lane| (lane as f32 * 0.37 - 20.0).to_bits())
                    .collect(),
            ),
        ];
        assert_interpreted(&module, &Lanes { columns }, |_| false);
    }
}

#[test]
fn bits_depend_neither_on_the_cut_nor_on_what_is_uniform() {
    let mut module = Module::default();
    nested(&mut module);
    let lanes = |count| Lanes {
        columns: vec![
            (Type::U32, vec![5; count]),
            (
                Type::F32,
                (0..count).map(|lane| (lane as f32).to_bits()).collect(),
            ),
        ],
    };
    let all = lanes(300).evaluate(&Evaluator::<f32>::new(&module), &mut Scratch::new());
    for count in [1, 127, 128, 129] {
        let found = lanes(count).evaluate(&Evaluator::<f32>::new(&module), &mut Scratch::new());
        assert!(
            found.iter().zip(&all).all(|(f, a)| f[..] == a[..count]),
            "{count}"
        );
    }
    assert_interpreted(&module, &lanes(300), |parameter| parameter == 0);
    let none = lanes(300).evaluate(&Evaluator::<f32>::new(&module), &mut Scratch::new());
    assert_eq!(bits(&none), bits(&all));
    let mut outputs = vec![vec![1.0]];
    let inputs = [Input::Integers(&[]), Input::Floats(&[])];
    Evaluator::<f32>::new(&module).evaluate(&mut Scratch::new(), &inputs, 0, &mut outputs);
    assert!(outputs.len() == 5 && outputs.iter().all(Vec::is_empty));
}

#[test]
fn a_program_reads_its_footprint_and_parameters_in_order() {
    let mut module = Module::default();
    let b = &Builder::new("entry", "Returns its parameters.");
    let parameters = [("a", Type::F32), ("b", Type::I32), ("c", Type::Bool)];
    for (name, ty) in FOOTPRINT.into_iter().chain(parameters) {
        b.result(name, b.scalar_param(name, ty));
    }
    b.finish(&mut module);
    let interface = Interface {
        name: "entry".into(),
        parameters: Vec::new(),
        outputs: Vec::new(),
        moments: false,
        position: false,
    };
    let program = Program { module, interface };
    let footprint = Footprint {
        cell: [-3, 4],
        uv: [0.5, 0.25],
        du: [0.1, 0.2],
        dv: [0.3, 0.4],
    };
    let outputs = eval_program::<f32>(
        &program,
        &[Footprint::default(), footprint],
        &[2.5, -7.0, 1.0],
    );
    let second: Vec<f32> = outputs.iter().map(|column| column[1]).collect();
    assert_eq!(
        second,
        [-3.0, 4.0, 0.5, 0.25, 0.1, 0.2, 0.3, 0.4, 2.5, -7.0, 1.0]
    );
}

#[test]
fn threads_share_an_evaluator() {
    fn shared<T: Send + Sync>() {}
    shared::<Evaluator<f32>>();
    shared::<Evaluator<f64>>();
}

/// The values of a type.
fn of_type<'b>(values: &[Scalar<'b>], ty: Type) -> Vec<Scalar<'b>> {
    values.iter().copied().filter(|v| v.ty() == ty).collect()
}

/// Adds random ops, loads and calls to a function, on values of all types that it has.
fn grow<'b>(b: &'b Builder, values: &mut Vec<Scalar<'b>>, callees: &[Callee], genes: &[[u8; 4]]) {
    for &[what, x, y, z] in genes {
        let pick = |ty: Type, gene: u8| {
            let fitting = of_type(values, ty);
            fitting[usize::from(gene) % fitting.len()]
        };
        let rows = Op::ALL.len();
        let choice = usize::from(what) % (rows + 12);
        if let Some(&op) = Op::ALL.get(choice) {
            let types = op.info().operands.iter().zip([x, y, z]);
            let operands: Vec<Scalar<'_>> = types.map(|(&ty, gene)| pick(ty, gene)).collect();
            values.push(b.dynamic(op, &operands));
        } else if choice < rows + 6 {
            let [p, q, r] = [x, y, z].map(|gene| pick(Type::F32, gene).float());
            let difference = if what.is_multiple_of(2) {
                r - p * q
            } else {
                p * q - r
            };
            values.push(difference.into());
        } else if choice < rows + 8 || callees.is_empty() {
            values.push(b.load(0, pick(Type::U32, x).uint()).into());
        } else {
            let callee = &callees[usize::from(x) % callees.len()];
            let gene = |i: usize| y.wrapping_mul(31).wrapping_add(z.wrapping_mul(i as u8));
            let types = callee.types.iter().enumerate();
            let arguments: Vec<Scalar<'_>> = types.map(|(i, &ty)| pick(ty, gene(i))).collect();
            values.extend(if choice < rows + 10 {
                b.call_any(&callee.function, arguments)
            } else {
                let count = pick(Type::U32, z).uint() & 3;
                let (state, captures) = arguments[1..].split_at(callee.function.results.len());
                b.fold(&callee.function, count, state.to_vec(), captures)
            });
        }
    }
}

struct Callee {
    function: FunctionRef,
    types: Vec<Type>,
}

/// Parameters of every generated function: a turn, a state of four and two captures.
const SHAPE: [Type; 7] = [
    Type::U32,
    Type::F32,
    Type::F32,
    Type::U32,
    Type::Bool,
    Type::I32,
    Type::F32,
];

fn generate(functions: &[Vec<[u8; 4]>]) -> Module {
    let mut module = Module::default();
    module.table("numbers", vec![0.5, -2.0, 3.25, 7.0]);
    let mut callees: Vec<Callee> = Vec::new();
    for (f, genes) in functions.iter().enumerate() {
        let b = &Builder::new(format!("f{f}"), "Generated.");
        let mut values = parameters(b, &SHAPE);
        values.extend([1.0, -0.75].map(|x| Scalar::from(b.float(x))));
        values.push(b.uint(0x9e37_79b9).into());
        grow(b, &mut values, &callees, genes);
        for (i, &ty) in SHAPE[1..5].iter().enumerate() {
            let fitting = of_type(&values, ty);
            // Mostly late values; sometimes parameters and constants.
            let gene = genes.get(i).map_or(0, |g| usize::from(g[3]));
            let back = if gene.is_multiple_of(4) {
                gene / 4
            } else {
                gene % 3
            };
            let last = fitting.len() - 1;
            b.result(format!("r{i}"), fitting[last - back % fitting.len()]);
        }
        let function = b.finish(&mut module);
        callees.push(Callee {
            function,
            types: SHAPE.to_vec(),
        });
    }
    module
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn random_programs_are_the_interpreters(
        functions in prop::collection::vec(prop::collection::vec(any::<[u8; 4]>(), 0..40), 1..4),
        seed in 0_u32..1000,
        uniform in 0_u32..128,
    ) {
        let module = generate(&functions);
        let column = |(i, &ty): (usize, &Type)| {
            let is_uniform = uniform >> i & 1 == 1;
            let lane = |lane: u32| seed + if is_uniform { 0 } else { lane * (i as u32 + 1) };
            (ty, (0..131).map(|l| sample(ty, lane(l) % 500)).collect())
        };
        let lanes = Lanes { columns: SHAPE.iter().enumerate().map(column).collect() };
        assert_interpreted(&module, &lanes, |parameter| uniform >> parameter & 1 == 1);
    }
}
