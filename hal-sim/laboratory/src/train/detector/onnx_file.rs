//! The network as an ONNX file: the messages of the format as far as they are needed (onnx.proto, ONNX 1.16).

use prost::Message;

use super::convolution::Convolution;
use super::network::{CELL, FRAME, Network, PIXEL_SCALE, STRIDES};

#[derive(Clone, PartialEq, Message)]
struct ModelProto {
    #[prost(int64, tag = "1")]
    ir_version: i64,
    #[prost(string, tag = "2")]
    producer_name: String,
    #[prost(message, optional, tag = "7")]
    graph: Option<GraphProto>,
    #[prost(message, repeated, tag = "8")]
    opset_import: Vec<OperatorSet>,
}

#[derive(Clone, PartialEq, Message)]
struct OperatorSet {
    #[prost(string, tag = "1")]
    domain: String,
    #[prost(int64, tag = "2")]
    version: i64,
}

#[derive(Clone, PartialEq, Message)]
struct GraphProto {
    #[prost(message, repeated, tag = "1")]
    node: Vec<NodeProto>,
    #[prost(string, tag = "2")]
    name: String,
    #[prost(message, repeated, tag = "5")]
    initializer: Vec<TensorProto>,
    #[prost(message, repeated, tag = "11")]
    input: Vec<ValueInfo>,
    #[prost(message, repeated, tag = "12")]
    output: Vec<ValueInfo>,
}

#[derive(Clone, PartialEq, Message)]
struct NodeProto {
    #[prost(string, repeated, tag = "1")]
    input: Vec<String>,
    #[prost(string, repeated, tag = "2")]
    output: Vec<String>,
    #[prost(string, tag = "3")]
    name: String,
    #[prost(string, tag = "4")]
    op_type: String,
    #[prost(message, repeated, tag = "5")]
    attribute: Vec<Attribute>,
}

#[derive(Clone, PartialEq, Message)]
struct Attribute {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(int64, tag = "3")]
    integer: i64,
    #[prost(int64, repeated, tag = "8")]
    integers: Vec<i64>,
    #[prost(int32, tag = "20")]
    kind: i32,
}

#[derive(Clone, PartialEq, Message)]
struct TensorProto {
    #[prost(int64, repeated, tag = "1")]
    dims: Vec<i64>,
    #[prost(int32, tag = "2")]
    data_type: i32,
    #[prost(string, tag = "8")]
    name: String,
    #[prost(bytes = "vec", tag = "9")]
    raw_data: Vec<u8>,
}

#[derive(Clone, PartialEq, Message)]
struct ValueInfo {
    #[prost(string, tag = "1")]
    name: String,
    #[prost(message, optional, tag = "2")]
    kind: Option<TypeProto>,
}

#[derive(Clone, PartialEq, Message)]
struct TypeProto {
    #[prost(message, optional, tag = "1")]
    tensor: Option<TensorType>,
}

#[derive(Clone, PartialEq, Message)]
struct TensorType {
    #[prost(int32, tag = "1")]
    element: i32,
    #[prost(message, optional, tag = "2")]
    shape: Option<Shape>,
}

#[derive(Clone, PartialEq, Message)]
struct Shape {
    #[prost(message, repeated, tag = "1")]
    dim: Vec<Dimension>,
}

#[derive(Clone, PartialEq, Message)]
struct Dimension {
    #[prost(int64, tag = "1")]
    value: i64,
}

/// Codes of the format: 32-bit floats, 64-bit integers, an attribute of one integer and of several.
const FLOAT: i32 = 1;
const INT64: i32 = 7;
const ONE: i32 = 2;
const SEVERAL: i32 = 7;
const INPUT: &str = "images";
const OUTPUT: &str = "output";

fn tensor(name: &str, dims: &[usize], values: impl Iterator<Item = f32>) -> TensorProto {
    TensorProto {
        dims: dims.iter().map(|side| *side as i64).collect(),
        data_type: FLOAT,
        name: name.to_owned(),
        raw_data: values.flat_map(f32::to_le_bytes).collect(),
    }
}

fn value(name: &str, sides: &[usize]) -> ValueInfo {
    let dim = sides.iter().map(|side| Dimension { value: *side as i64 }).collect();
    let tensor = TensorType { element: FLOAT, shape: Some(Shape { dim }) };
    ValueInfo { name: name.to_owned(), kind: Some(TypeProto { tensor: Some(tensor) }) }
}

fn several(name: &str, integers: &[usize]) -> Attribute {
    let integers = integers.iter().map(|one| *one as i64).collect();
    Attribute { name: name.to_owned(), integers, kind: SEVERAL, integer: 0 }
}

/// The graph while it grows.
#[derive(Default)]
struct Graph {
    node: Vec<NodeProto>,
    initializer: Vec<TensorProto>,
}

impl Graph {
    /// Adds a node with one answer, whose name it gives.
    fn node(&mut self, op_type: &str, input: &[&str], attribute: Vec<Attribute>) -> String {
        let name = format!("{}{}", op_type.to_lowercase(), self.node.len());
        self.node.push(NodeProto {
            input: input.iter().map(|one| (*one).to_owned()).collect(),
            output: vec![name.clone()],
            name: name.clone(),
            op_type: op_type.to_owned(),
            attribute,
        });
        name
    }

    /// A convolution of some output channels; its weights are multiplied by a factor.
    fn convolution(
        &mut self,
        layer: &Convolution,
        input: &str,
        (channels, factor): (std::ops::Range<usize>, f32),
    ) -> String {
        let form = layer.form;
        let (name, depth) = (format!("layer{}", self.initializer.len()), form.into * form.side * form.side);
        let weights = &layer.weights[channels.start * depth..channels.end * depth];
        let dims = [channels.len(), form.into, form.side, form.side];
        let names = [format!("{name}.weight"), format!("{name}.bias")];
        self.initializer.push(tensor(&names[0], &dims, weights.iter().map(|weight| weight * factor)));
        self.initializer.push(tensor(&names[1], &[channels.len()], layer.bias[channels].iter().copied()));
        let attributes = vec![
            several("kernel_shape", &[form.side; 2]),
            several("strides", &[form.step; 2]),
            several("pads", &[form.pad(); 4]),
        ];
        self.node("Conv", &[input, &names[0], &names[1]], attributes)
    }

    /// One grid: place and size, objectness and class behind sigmoids, as rows of numbers for all its cells.
    fn grid(&mut self, head: &Convolution, (input, cells): (&str, usize)) -> String {
        let place = self.convolution(head, input, (0..CELL - 1, 1.0));
        let sure = self.convolution(head, input, (CELL - 1..CELL, 1.0));
        let sure = self.node("Sigmoid", &[&sure], Vec::new());
        // The only class is sure: objectness by objectness of a layer without weights and with a great bias.
        let mut class = head.clone();
        class.weights.fill(0.0);
        class.bias.fill(30.0);
        let class = self.convolution(&class, input, (0..1, 1.0));
        let class = self.node("Sigmoid", &[&class], Vec::new());
        let one = |name: &str, integer| Attribute {
            name: name.to_owned(),
            integer,
            kind: ONE,
            integers: Vec::new(),
        };
        let joined = self.node("Concat", &[&place, &sure, &class], vec![one("axis", 1)]);
        let shape = format!("shape{}", self.initializer.len());
        let sides = [1, CELL as i64 + 1, cells as i64];
        self.initializer.push(TensorProto {
            dims: vec![3],
            data_type: INT64,
            name: shape.clone(),
            raw_data: sides.iter().flat_map(|side| side.to_le_bytes()).collect(),
        });
        self.node("Reshape", &[&joined, &shape], Vec::new())
    }
}

/// The bytes of the file. Input: 1 × 3 × 128 × 160, blue, green, red, 0 to 255; output: 1 × cells × 6, as YOLOX writes it before it is
/// decoded.
#[must_use]
pub fn onnx_file(network: &Network) -> Vec<u8> {
    let [width, height] = FRAME.map(|side| side as usize);
    let mut graph = Graph::default();
    let (mut input, mut grids, mut all) = (INPUT.to_owned(), Vec::new(), 0);
    for (number, layer) in network.trunk.iter().enumerate() {
        let factor = if number == 0 { PIXEL_SCALE } else { 1.0 };
        let answer = graph.convolution(layer, &input, (0..layer.form.out, factor));
        input = graph.node("Relu", &[&answer], Vec::new());
        if let Some(grid) = Network::grid_after(number) {
            let cells = (width / STRIDES[grid]) * (height / STRIDES[grid]);
            grids.push(graph.grid(&network.heads[grid], (&input, cells)));
            all += cells;
        }
    }
    let names: Vec<&str> = grids.iter().map(String::as_str).collect();
    let axis = Attribute { name: "axis".to_owned(), integer: 2, kind: ONE, integers: Vec::new() };
    let joined = graph.node("Concat", &names, vec![axis]);
    let mut last = graph.node("Transpose", &[&joined], vec![several("perm", &[0, 2, 1])]);
    if let Some(node) = graph.node.last_mut() {
        OUTPUT.clone_into(&mut last);
        node.output = vec![last];
    }
    let model = ModelProto {
        ir_version: 8,
        producer_name: "floorguard".to_owned(),
        graph: Some(GraphProto {
            node: graph.node,
            name: "people".to_owned(),
            initializer: graph.initializer,
            input: vec![value(INPUT, &[1, 3, height, width])],
            output: vec![value(OUTPUT, &[1, all, CELL + 1])],
        }),
        opset_import: vec![OperatorSet { domain: String::new(), version: 13 }],
    };
    model.encode_to_vec()
}
