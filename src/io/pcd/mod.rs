//! PCD, the Point Cloud Library's format: ascii, binary and `binary_compressed`. Read only.
//!
//! Read here and not by `pcd-rs`, which allocates what a header claims and panics where the claims
//! contradict each other; tests compare with it. Points without a reading are NaN in all three
//! coordinates; they are dropped, and counted, in [`super::read`].

mod header;
mod lzf;

use super::fault::{Fault, Place};
use super::raw::{Raw, RawGrid};
use super::source::{Source, number, shown, words};
use crate::geom::{Point3, PointCloud, Surface, Vector3};
use header::{Encoding, Field, Header, Kind};

/// Reads a PCD file.
pub(super) fn read(source: &mut Source<'_>) -> Result<Raw, Fault> {
    let header = Header::read(source)?;
    let columns = Columns::of(&header, source.line_place())?;
    let cloud = match header.encoding {
        Encoding::Ascii => read_ascii(source, &header, &columns)?,
        Encoding::Binary => read_binary(source, &header, &columns)?,
        Encoding::Compressed => read_compressed(source, &header, &columns)?,
    };
    let grid = header.grid.map(|[width, height]| RawGrid { width, height, cells: None });
    Ok(Raw { metres_are_customary: true, grid, ..Raw::new(Surface::Points(cloud)) })
}

/// Which fields are used, as indices into the header's.
struct Columns {
    position: [usize; 3],
    normal: Option<[usize; 3]>,
    /// Red, green and blue packed into one value.
    color: Option<usize>,
}

impl Columns {
    fn of(header: &Header, place: Place) -> Result<Self, Fault> {
        let one = |name: &str| header.fields.iter().position(|field| field.name == name);
        let three = |a: &str, b: &str, c: &str| Some([one(a)?, one(b)?, one(c)?]);
        let position = three("x", "y", "z")
            .ok_or_else(|| Fault::malformed(place, "the fields x, y and z are not all there"))?;
        Ok(Self {
            position,
            normal: three("normal_x", "normal_y", "normal_z"),
            color: one("rgb").or_else(|| one("rgba")).filter(|i| header.fields[*i].size == 4),
        })
    }

    /// Adds a point whose first value of field `i` is `value(i)`, its bits `bits(i)`.
    fn push(
        &self,
        cloud: &mut PointCloud,
        value: impl Fn(usize) -> f64,
        bits: impl Fn(usize) -> u32,
    ) {
        cloud.points.push(Point3::from(self.position.map(&value)));
        if let Some(normal) = self.normal {
            let normal = Vector3::from(normal.map(&value));
            cloud.normals.get_or_insert_default().push(normal);
        }
        if let Some(color) = self.color {
            let [b, g, r, _] = bits(color).to_le_bytes();
            cloud.colors.get_or_insert_default().push([r, g, b]);
        }
    }
}

fn read_ascii(
    source: &mut Source<'_>,
    header: &Header,
    columns: &Columns,
) -> Result<PointCloud, Fault> {
    let n_values = header.fields.iter().map(|field| field.count).sum::<usize>();
    let n_points = source.count(header.n_points, 2 * n_values as u64, "points")?;
    let mut cloud = PointCloud::default();
    let mut line = Vec::new();
    while cloud.points.len() < n_points {
        if !source.read_line(&mut line)? {
            let what = format!("point {} of {n_points}", cloud.points.len() + 1);
            return Err(Fault::Truncated { place: source.line_place(), what });
        }
        if line.trim_ascii().is_empty() {
            continue;
        }
        let row: Vec<&[u8]> = words(&line).collect();
        let place = source.line_place();
        if row.len() != n_values {
            let n = row.len();
            let problem = format!("{n} values where the header promises {n_values}");
            return Err(Fault::malformed(place, problem));
        }
        let first = |i: usize| row[header.fields[i].first_value];
        for &i in columns.position.iter().chain(columns.normal.iter().flatten()) {
            if number(first(i)).is_none() {
                let problem = format!("{} where a number must be", shown(first(i)));
                return Err(Fault::malformed(place, problem));
            }
        }
        let value = |i: usize| number(first(i)).unwrap_or(f64::NAN);
        let bits = |i: usize| match header.fields[i].kind {
            Kind::Float => (value(i) as f32).to_bits(),
            _ => value(i) as i64 as u32,
        };
        columns.push(&mut cloud, value, bits);
    }
    Ok(cloud)
}

fn read_binary(
    source: &mut Source<'_>,
    header: &Header,
    columns: &Columns,
) -> Result<PointCloud, Fault> {
    let n_points = source.count(header.n_points, header.record_size() as u64, "points")?;
    let mut cloud = PointCloud::default();
    let mut record = vec![0; header.record_size()];
    for _ in 0..n_points {
        source.fill(&mut record, "a point")?;
        let cell = |i: usize| &record[header.fields[i].offset..];
        columns.push(
            &mut cloud,
            |i| header.fields[i].value(cell(i)),
            |i| header.fields[i].bits(cell(i)) as u32,
        );
    }
    Ok(cloud)
}

/// Field after field, each with the values of all points, compressed as one block.
fn read_compressed(
    source: &mut Source<'_>,
    header: &Header,
    columns: &Columns,
) -> Result<PointCloud, Fault> {
    let n_packed = u32::from_le_bytes(source.bytes("the compressed size")?);
    let n_bytes = u32::from_le_bytes(source.bytes("the uncompressed size")?);
    let place = source.byte_place();
    let expected = header.n_points.checked_mul(header.record_size() as u64);
    if expected != Some(u64::from(n_bytes)) {
        let (n_points, record) = (header.n_points, header.record_size());
        let problem = format!("{n_bytes} bytes for {n_points} points of {record} bytes");
        return Err(Fault::malformed(place, problem));
    }
    let packed = source.block(n_packed.into(), "the compressed points")?;
    let bytes = lzf::decompress(&packed, n_bytes as usize)
        .ok_or_else(|| Fault::malformed(place, "the compressed block is damaged"))?;
    let n_points = header.n_points as usize;
    let mut cloud = PointCloud::default();
    for i_point in 0..n_points {
        let cell = |i: usize| {
            let field = &header.fields[i];
            &bytes[field.offset * n_points + i_point * field.size * field.count..]
        };
        columns.push(
            &mut cloud,
            |i| header.fields[i].value(cell(i)),
            |i| header.fields[i].bits(cell(i)) as u32,
        );
    }
    Ok(cloud)
}

impl Field {
    /// The first value of the field, at the front of `cell`.
    fn value(&self, cell: &[u8]) -> f64 {
        let bits = self.bits(cell);
        let unused = 64 - 8 * self.size as u32;
        match (self.kind, self.size) {
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            (Kind::Signed, _) => ((bits << unused).cast_signed() >> unused) as f64,
            (Kind::Unsigned, _) => bits as f64,
        }
    }

    fn bits(&self, cell: &[u8]) -> u64 {
        let mut bytes = [0; 8];
        bytes[..self.size].copy_from_slice(&cell[..self.size]);
        u64::from_le_bytes(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pcd(header: &str, data: &[u8]) -> Result<PointCloud, Fault> {
        let bytes = [format!("# .PCD v0.7\nVERSION 0.7\n{header}").as_bytes(), data].concat();
        let raw = read(&mut Source::new(&mut bytes.as_slice(), bytes.len() as u64))?;
        Ok(raw.surface.into_points())
    }

    const XYZ: &str = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

    #[test]
    fn colours_are_unpacked_from_a_float_and_from_an_integer() {
        for (kind, text) in
            [("F", f32::from_bits(0x00ff_8001).to_string()), ("U", "16744449".into())]
        {
            let header = format!(
                "FIELDS x y z _ rgb\nSIZE 4 4 4 1 4\nTYPE F F F U {kind}\nCOUNT 1 1 1 2 1\n\
                 WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"
            );
            let cloud = pcd(&header, format!("1 2 3 0 0 {text}\n").as_bytes()).unwrap();
            assert_eq!(cloud.colors, Some(vec![[255, 128, 1]]), "{kind}");
        }
    }

    #[test]
    fn a_compressed_block_may_repeat_itself() {
        // Two points (1, 1, 1): 24 bytes of 0 0 80 3f: one literal run, then a copy of 20 bytes.
        let packed = [3, 0, 0, 0x80, 0x3f, 0xe0, 11, 3];
        let sizes = [8_u32.to_le_bytes(), 24_u32.to_le_bytes()].concat();
        let header = format!("{XYZ}WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary_compressed\n");
        let cloud = pcd(&header, &[&sizes[..], &packed].concat()).unwrap();
        assert_eq!(cloud.points, [Point3::new(1.0, 1.0, 1.0); 2]);
    }

    #[test]
    fn faults_name_place_and_value() {
        let tail =
            |n: &str, data: &str| format!("{XYZ}WIDTH 1\nHEIGHT 1\nPOINTS {n}\nDATA {data}\n");
        let sizes = |a: u32, b: u32| [a.to_le_bytes(), b.to_le_bytes()].concat();
        let cases = [
            (tail("1", "ascii"), b"10 20\n".to_vec(), "2 values where the header promises 3"),
            (tail("1", "ascii"), b"1 2 q\n".to_vec(), "line 11: \"q\" where a number"),
            (tail("2", "ascii"), b"1 2 3\n".to_vec(), "promises 2 points, but the 6 bytes"),
            (tail("1", "zipped"), vec![], "line 10: \"DATA zipped\" is no PCD header line"),
            (tail("99999999999", "binary"), vec![0; 30], "hold 2 at most"),
            (tail("1", "binary_compressed"), sizes(9, 12), "the middle of the compressed points"),
            (tail("1", "binary_compressed"), sizes(9, 13), "13 bytes for 1 points of 12 bytes"),
            (tail("1", "binary_compressed"), [sizes(1, 12), vec![7]].concat(), "block is damaged"),
            (XYZ.replace("SIZE 4 4 4", "SIZE 4 4"), vec![], "in the middle of the header"),
        ];
        for (header, data, message) in cases {
            let error = pcd(&header, &data).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
