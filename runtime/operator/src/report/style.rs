//! How both pages look: on a phone, on a screen and on paper, without anything from elsewhere.

use floorguard_host::words::beside;

/// The style sheet. A picture is drawn for a screen; on a phone its words and marks grow, and every other mark of an axis
/// goes, so that what is left can be read without a magnifying glass.
pub const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;margin:1rem auto;max-width:64rem;padding:0 1rem;\
color:#1c2733;background:#fff;overflow-wrap:break-word}h1{font-size:1.5rem;margin-bottom:0}h2{font-size:1.15rem;\
margin-top:2rem}h3{font-size:1rem;margin:1rem 0 .3rem}svg{display:block;width:100%;height:auto;max-height:90vh}\
.sum{display:flex;flex-wrap:wrap;gap:.6rem;padding:0;list-style:none}.sum li{background:#f4f6f8;border-radius:.5rem;\
padding:.4rem .8rem;flex:1 1 7.8rem;\
box-sizing:border-box}.sum b{display:block;font-size:1.25rem}.sum .good{background:#dff0e0}\
.sum .bad{background:#f9d9d5}table{border-collapse:collapse;width:100%;font-size:.92rem}td,th{padding:.25rem .5rem;\
text-align:left;vertical-align:top;border-bottom:1px solid #d8dee5}.num{text-align:right;\
font-variant-numeric:tabular-nums;white-space:nowrap}.wide{overflow-x:auto}.why{min-width:13rem}.stop{display:flex;flex-wrap:wrap;gap:1rem;\
border-top:1px solid #d8dee5;padding:1rem 0;break-inside:avoid}.stop>div{flex:1 1 16rem}.stop svg{flex:0 1 300px;\
max-width:300px}dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem .8rem;margin:0}dt{color:#5b6770}\
dd{margin:0;min-width:0}.facts{gap:.3rem 1rem;margin:1rem 0}.proof{margin:.5rem 0}\
.sign{display:none}.cut{background:#fdf2d0;padding:.5rem 1rem;border-radius:.5rem}\
.pair{display:flex;flex-wrap:wrap;gap:1rem}figure{flex:1 1 18rem;margin:0;break-inside:avoid}figcaption{text-align:center}\
.slide{display:flex;flex-wrap:wrap;gap:.2rem .8rem;align-items:center;margin:.5rem 0}\
.slide input{flex:1;min-width:0;min-height:2.5rem}.slide output{flex:1 1 100%;font-variant-numeric:tabular-nums}.legend{color:#5b6770;font-size:.88rem}.key{white-space:nowrap;margin-right:1rem;display:inline-block}.key i{display:\
inline-block;width:1em;height:1em;border:1px solid #888;vertical-align:-.1em;margin-right:.3em}.disc{display:inline-block;\
min-width:1.6em;border-radius:1em;color:#fff;text-align:center;font-size:.85em}\
@media screen and (max-width:40rem){dl.facts{display:block}.facts dt{margin-top:.4rem}.chart text{font-size:23px}\
.chart .odd{display:none}.map text{font-size:28px}.map .mark circle{r:14px}.map .mark text{font-size:19px}\
.stop svg{max-width:15rem}\
td,th{padding:.25rem .3rem}}\
@page{margin:14mm}@media print{.slide,#now{display:none}.sign{display:flex;gap:2rem;margin-top:14mm;break-inside:avoid}.sign div{flex:1;\
border-top:1px solid #1c2733;padding-top:.2rem;font-size:10px}.proof{break-inside:avoid}*{print-color-adjust:exact;-webkit-print-color-adjust:exact}body{max-width:none;margin:0;font-size:11px}\
svg{max-height:45vh;break-inside:avoid}.stop{padding:.4rem 0}.stop svg{max-width:150px}h2,h3,tr:first-child{break-after:avoid}\
li,tr,.stop{break-inside:avoid}a{color:inherit}}";

/// The page up to its heading.
pub fn head(title: &str) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width,initial-scale=1\"><title>floorguard: {t}</title><style>{STYLE}</style>\
         <main><h1>{t}</h1>",
        t = escaped(title)
    )
}

/// Text that means nothing to HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// One figure of the first glance: the value, what it is, and a class for its colour.
pub type Tile = (String, &'static str, &'static str);

/// The figures of the first glance.
pub fn tiles(tiles: impl IntoIterator<Item = Tile>) -> String {
    let tiles = tiles.into_iter().map(|(value, what, class)| {
        let class = if class.is_empty() { String::new() } else { format!(" class={class}") };
        format!("<li{class}><b>{}</b>{what}</li>", escaped(&value))
    });
    format!("<ul class=sum>{}</ul>", tiles.collect::<String>())
}

/// A tile that counts: what is counted, one and many of it.
pub fn count_tile(count: u64, one: &'static str, many: &'static str) -> Tile {
    (grouped(count), beside(count, one, many), "")
}

/// A chart over time.
pub fn chart(svg: &str) -> String {
    format!("<div class=chart>{svg}</div>")
}

/// A picture with marks that grow on a phone.
pub fn map(svg: &str) -> String {
    format!("<div class=map>{svg}</div>")
}

/// Digits in groups of three.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
    rest.as_bytes().chunks(3).fold(first.to_owned(), |all, three| {
        let three = three.iter().copied().map(char::from);
        all + "," + &three.collect::<String>()
    })
}

#[cfg(test)]
mod tests {
    use super::{count_tile, grouped, tiles};

    #[test]
    fn one_is_not_many_on_a_tile() {
        let html = tiles([0, 1, 2].map(|count| count_tile(count, "stop", "stops")));
        assert_eq!(
            html,
            "<ul class=sum><li><b>0</b>stops</li><li><b>1</b>stop</li><li><b>2</b>stops</li></ul>"
        );
    }

    #[test]
    fn digits_stand_in_groups_of_three() {
        let all = [0, 7, 999, 1_000, 257_101, 1_000_000].map(grouped);
        assert_eq!(all, ["0", "7", "999", "1,000", "257,101", "1,000,000"]);
    }
}
