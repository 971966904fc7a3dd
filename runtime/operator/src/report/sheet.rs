//! Plain sheets of paper: A4 pages of headings, facts, tables and a plan, written as a PDF file.
//!
//! The typefaces are two of the fourteen that every reader has (ISO 32000-1, 9.6.2.2), in WinAnsi: all letters of the panel's
//! languages. Letters outside of it become question marks.

use pdf_writer::{Content, Name, Pdf, Rect, Ref, Str};

/// A4, points.
const PAGE: (f32, f32) = (595.0, 842.0);
/// Free on each side, points.
const MARGIN: f32 = 50.0;
/// Size of the text and distance of its lines, points.
const TEXT: f32 = 10.0;
const LINE: f32 = 14.5;
/// Width of a letter in sizes, on the average of Helvetica.
const LETTER: f32 = 0.52;

/// Sheets in the making.
pub struct Sheet {
    pages: Vec<Content>,
    y: f32,
}

impl Sheet {
    /// Begins with a heading.
    #[must_use]
    pub fn new(heading: &str) -> Self {
        let mut sheet = Self { pages: vec![Content::new()], y: PAGE.1 - MARGIN };
        sheet.down(12.0);
        sheet.text((MARGIN, true, 18.0), heading);
        sheet.down(8.0);
        sheet
    }

    /// Goes down; to a new page where this one ends.
    fn down(&mut self, by: f32) {
        self.y -= by;
        if self.y < MARGIN {
            self.pages.push(Content::new());
            self.y = PAGE.1 - MARGIN - LINE;
        }
    }

    fn page(&mut self) -> &mut Content {
        if self.pages.is_empty() {
            self.pages.push(Content::new());
        }
        let last = self.pages.len() - 1;
        &mut self.pages[last]
    }

    fn text(&mut self, (x, is_bold, size): (f32, bool, f32), text: &str) {
        let (y, bytes) = (self.y, encoded(text));
        let page = self.page();
        page.begin_text().set_font(Name(if is_bold { b"B" } else { b"R" }), size);
        page.next_line(x, y).show(Str(&bytes)).end_text();
    }

    /// A heading in between.
    pub fn heading(&mut self, text: &str) {
        // Not alone at the foot of a page.
        if self.y < MARGIN + 4.0 * LINE {
            self.down(self.y);
        }
        self.down(LINE + 12.0);
        self.text((MARGIN, true, 13.0), text);
        self.down(3.0);
    }

    /// A row of columns: where each begins, points from the margin, and its text. Long text goes on in the next line.
    pub fn row(&mut self, columns: &[(f32, &str)], is_bold: bool) {
        let starts: Vec<f32> = columns.iter().map(|(start, _)| *start).collect();
        let width = PAGE.0 - 2.0 * MARGIN;
        let lines: Vec<Vec<String>> = columns
            .iter()
            .enumerate()
            .map(|(index, (start, text))| {
                let end = starts.get(index + 1).copied().unwrap_or(width);
                wrapped(text, ((end - start - 6.0) / (LETTER * TEXT)).max(4.0) as usize)
            })
            .collect();
        for line in 0..lines.iter().map(Vec::len).max().unwrap_or(0) {
            self.down(LINE);
            for (start, words) in starts.iter().zip(&lines) {
                if let Some(words) = words.get(line) {
                    self.text((MARGIN + start, is_bold, TEXT), words);
                }
            }
        }
    }

    /// A thin line across.
    pub fn rule(&mut self) {
        self.down(4.0);
        let y = self.y;
        let page = self.page();
        page.set_line_width(0.5).move_to(MARGIN, y).line_to(PAGE.0 - MARGIN, y).stroke();
    }

    /// Coloured squares of a plan, each with column and row from below, and its colour; drawn as large as the page permits.
    pub fn plan(
        &mut self,
        (columns, rows): (usize, usize),
        cells: impl Iterator<Item = (usize, usize, [f32; 3])>,
    ) {
        let edge = ((PAGE.0 - 2.0 * MARGIN) / columns.max(1) as f32).min(300.0 / rows.max(1) as f32);
        if self.y - edge * (rows as f32) < MARGIN + LINE {
            self.down(self.y);
        }
        self.down(edge * rows as f32 + 6.0);
        let low = self.y;
        let page = self.page();
        // Neighbours of one colour in a row become one rectangle.
        let mut cells = cells.peekable();
        while let Some((column, row, colour)) = cells.next() {
            let mut wide = 1;
            while cells.next_if_eq(&(column + wide, row, colour)).is_some() {
                wide += 1;
            }
            let [red, green, blue] = colour;
            let (x, y) = (MARGIN + edge * column as f32, low + edge * row as f32);
            page.set_fill_rgb(red, green, blue)
                .rect(x, y, edge * (wide as f32 + 0.02), edge * 1.02)
                .fill_nonzero();
        }
        page.set_fill_rgb(0.0, 0.0, 0.0);
    }

    /// Lines to sign on.
    pub fn signatures(&mut self, names: &[&str]) {
        self.down(60.0);
        let width = (PAGE.0 - 2.0 * MARGIN) / names.len().max(1) as f32;
        for (index, name) in names.iter().enumerate() {
            let x = MARGIN + width * index as f32;
            let y = self.y + 11.0;
            self.page().set_line_width(0.5).move_to(x, y).line_to(x + width - 20.0, y).stroke();
            self.text((x, false, 8.0), name);
        }
    }

    /// The file.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        let (catalog, tree, regular, bold) = (Ref::new(1), Ref::new(2), Ref::new(3), Ref::new(4));
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(tree);
        let count = self.pages.len() as i32;
        pdf.pages(tree).kids((0..count).map(|page| Ref::new(5 + 2 * page))).count(count);
        for (font, name) in [(regular, Name(b"Helvetica")), (bold, Name(b"Helvetica-Bold"))] {
            pdf.type1_font(font).base_font(name).encoding_predefined(Name(b"WinAnsiEncoding"));
        }
        for (number, content) in (0..count).zip(self.pages) {
            let (page_ref, content_ref) = (Ref::new(5 + 2 * number), Ref::new(6 + 2 * number));
            let mut page = pdf.page(page_ref);
            page.media_box(Rect::new(0.0, 0.0, PAGE.0, PAGE.1)).parent(tree).contents(content_ref);
            page.resources().fonts().pair(Name(b"R"), regular).pair(Name(b"B"), bold);
            page.finish();
            pdf.stream(content_ref, &content.finish());
        }
        pdf.finish()
    }
}

use pdf_writer::Finish as _;

/// In WinAnsi, which is Latin-1 with a few more letters where Latin-1 has none (ISO 32000-1, annex D).
fn encoded(text: &str) -> Vec<u8> {
    let byte = |letter: char| match letter {
        '€' => 0x80,
        '…' => 0x85,
        'Œ' => 0x8C,
        'œ' => 0x9C,
        '‘' => 0x91,
        '’' => 0x92,
        '“' => 0x93,
        '”' => 0x94,
        '„' => 0x84,
        '–' => 0x96,
        '—' => 0x97,
        letter => {
            u8::try_from(u32::from(letter)).ok().filter(|byte| !(0x80..0xA0).contains(byte)).unwrap_or(b'?')
        }
    };
    text.chars().map(byte).collect()
}

fn wrapped(text: &str, letters_max: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().map_or(0, |line| line.chars().count());
        if line > 0 && line + 1 + word.chars().count() > letters_max {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_wraps_and_long_sheets_have_pages() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("", 7), [""]);
        assert_eq!(encoded("Fläche m² – œ €"), b"Fl\xE4che m\xB2 \x96 \x9C \x80");
        assert_eq!(encoded("床"), b"?");
        let mut sheet = Sheet::new("heading");
        (0..100).for_each(|row| sheet.row(&[(0.0, &row.to_string()), (100.0, "text")], false));
        assert_eq!(sheet.pages.len(), 2);
        let file = sheet.finish();
        assert!(file.starts_with(b"%PDF-1.") && file.ends_with(b"%%EOF"));
    }
}
