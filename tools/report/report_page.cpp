#include "tools/report/report_page.h"

#include <fmt/format.h>

#include "tools/report/svg.h"
#include "tools/report/theme.h"

namespace tectum {
namespace {

constexpr std::string_view kPageCss = R"css(
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--fg);font:15px/1.5 system-ui,-apple-system,'Segoe UI','DejaVu Sans',Roboto,sans-serif}
main{max-width:1180px;margin:0 auto;padding:20px 24px 60px}
h1{font-size:26px;line-height:1.2;margin:8px 0 2px}
h2{font-size:18px;margin:36px 0 4px}
h3{font-size:14px;margin:0}
p{margin:4px 0 10px;max-width:78ch}
h1+p{max-width:none}
.muted,figcaption{color:var(--muted)}
figcaption{font-size:13px;max-width:90ch;margin:0 0 6px}
figure{margin:14px 0 22px}
svg{display:block;width:100%;height:auto}
svg.narrow{display:none}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(132px,1fr));gap:10px;margin:16px 0}
.card{background:var(--panel);border-radius:10px;padding:10px 14px}
.card b{display:block;font-size:22px;line-height:1.25;font-weight:600}
.card span{font-size:12.5px;line-height:1.3;display:block;color:var(--muted)}
.grid{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(340px,100%),1fr));gap:6px 28px}
table{border-collapse:collapse;width:100%;margin:8px 0 16px;font-variant-numeric:tabular-nums}
th,td{padding:5px 6px;text-align:right;border-bottom:1px solid var(--grid);vertical-align:top}
td:not(:first-child){white-space:nowrap}
th:first-child,td:first-child{text-align:left;padding-left:0}
thead th{font-size:13px;color:var(--muted);font-weight:600}
table.text th,table.text td{text-align:left;white-space:normal;overflow-wrap:anywhere}
table.text td:first-child,table.text th:first-child{min-width:6.5em;overflow-wrap:normal}
table.text td:nth-child(2){min-width:4.2em}
td small{display:block;color:var(--muted);font-size:12px;line-height:1.3}
details>summary{cursor:pointer;color:var(--muted);margin:8px 0}
code{font-size:13px;overflow-wrap:anywhere}
#tip{position:fixed;pointer-events:none;background:var(--panel);border:1px solid var(--grid);border-radius:8px;padding:6px 9px;font-size:12.5px;line-height:1.4;display:none;z-index:9;white-space:nowrap}
.cursorline{stroke:var(--fg);stroke-width:1;opacity:.55}
@media (max-width:760px){
main{padding:12px 12px 40px}
body{font-size:14px}
h1{font-size:21px}
svg.wide{display:none}
svg.narrow{display:block}
th,td{padding:5px 3px;font-size:13px}
.grid{gap:6px}
}
@media print{svg.wide{display:block}svg.narrow{display:none}}
)css";

// Values under the pointer, read back from the drawn lines, with a hair line in every chart that shares the x axis.
constexpr std::string_view kCursorScript = R"js(
(() => {
  const tip = document.getElementById('tip');
  const charts = [...document.querySelectorAll('svg.cursor')].map(svg => {
    const plot = svg.querySelector('g.plot');
    const lines = [...svg.querySelectorAll('path[data-name]')].map(path => {
      const v = path.getAttribute('d').split(/[ML ]/).filter(s => s).map(Number);
      const xs = [], ys = [];
      for (let k = 0; v.length > k + 1; k += 2) { xs.push(v[k]); ys.push(v[k + 1]); }
      return {name: path.dataset.name, xs, ys};
    });
    const hair = document.createElementNS(svg.namespaceURI, 'path');
    hair.setAttribute('class', 'cursorline');
    svg.appendChild(hair);
    return {svg, lines, hair, x: plot.dataset.x.split(' ').map(Number), y: plot.dataset.y.split(' ').map(Number)};
  });
  const value = (axis, px) => axis[0] + (px - axis[2]) / (axis[3] - axis[2]) * (axis[1] - axis[0]);
  const clear = () => { tip.style.display = 'none'; charts.forEach(c => c.hair.removeAttribute('d')); };
  const show = (chart, event) => {
    const m = chart.svg.getScreenCTM();
    const px = (event.clientX - m.e) / m.a;
    if (chart.x[2] > px || px > chart.x[3]) { clear(); return; }
    const at = value(chart.x, px);
    charts.forEach(c => {
      const cx = c.x[2] + (at - c.x[0]) / (c.x[1] - c.x[0]) * (c.x[3] - c.x[2]);
      if (c.x[2] > cx || cx > c.x[3]) c.hair.removeAttribute('d');
      else c.hair.setAttribute('d', 'M' + cx + ' ' + c.y[3] + 'V' + c.y[2]);
    });
    tip.textContent = '';
    const row = text => { const div = document.createElement('div'); div.textContent = text; tip.appendChild(div); };
    row(at.toFixed(3) + ' s');
    chart.lines.forEach(line => {
      let low = 0, high = line.xs.length - 1;
      while (high > low) { const mid = (low + high + 1) >> 1; if (line.xs[mid] > px) high = mid - 1; else low = mid; }
      if (line.xs.length) row(line.name + ': ' + value(chart.y, line.ys[low]).toFixed(2));
    });
    tip.style.display = 'block';
    tip.style.left = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8) + 'px';
    tip.style.top = Math.max(8, event.clientY - tip.offsetHeight - 12) + 'px';
  };
  charts.forEach(chart => {
    chart.svg.addEventListener('pointermove', event => show(chart, event));
    chart.svg.addEventListener('pointerleave', clear);
  });
})();
)js";

}  // namespace

void ReportPage::heading(std::string_view title) { body_ += fmt::format("<h2>{}</h2>\n", xml_escape(title)); }

void ReportPage::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", xml_escape(text)); }

void ReportPage::cards(const std::vector<ReportCard>& cards) {
  body_ += "<div class=\"cards\">";
  for (const ReportCard& card : cards) {
    body_ += fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>", xml_escape(card.value),
                         xml_escape(card.label));
  }
  body_ += "</div>\n";
}

void ReportPage::table(const ReportTable& table) {
  body_ += table.holds_text ? "<table class=\"text\"><thead><tr>" : "<table><thead><tr>";
  for (const std::string& cell : table.header) {
    body_ += fmt::format("<th>{}</th>", xml_escape(cell));
  }
  body_ += "</tr></thead><tbody>\n";
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    body_ += "<tr>";
    for (std::size_t c = 0; c < table.rows[r].size(); ++c) {
      body_ += fmt::format("<td>{}", xml_escape(table.rows[r][c]));
      if (c == 0 && r < table.notes.size() && !table.notes[r].empty()) {
        body_ += fmt::format("<small>{}</small>", xml_escape(table.notes[r]));
      }
      body_ += "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table>\n";
}

void ReportPage::figure(std::string_view title, std::string_view caption, std::string_view svg) {
  body_ += fmt::format("<figure><h3>{}</h3>", xml_escape(title));
  if (!caption.empty()) {
    body_ += fmt::format("<figcaption>{}</figcaption>", xml_escape(caption));
  }
  body_ += fmt::format("{}</figure>\n", svg);
}

void ReportPage::begin_grid() { body_ += "<div class=\"grid\">\n"; }
void ReportPage::end_grid() { body_ += "</div>\n"; }

void ReportPage::begin_details(std::string_view summary) {
  body_ += fmt::format("<details><summary>{}</summary>\n", xml_escape(summary));
}
void ReportPage::end_details() { body_ += "</details>\n"; }

std::string ReportPage::finish(std::string_view title, std::string_view subtitle) const {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/><title>{0}</title>\n<style>{1}{2}{3}"
      "</style></head>\n<body><main>\n<h1>{0}</h1>\n<p class=\"muted\">{4}</p>\n{5}</main>\n<div id=\"tip\"></div>\n"
      "<script>//<![CDATA[{6}//]]></script>\n</body></html>\n",
      xml_escape(title), theme_variables_css(), kPageCss, chart_css(), xml_escape(subtitle), body_, kCursorScript);
}

}  // namespace tectum
