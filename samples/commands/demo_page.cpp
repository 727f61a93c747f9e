#include <fmt/format.h>

#include "samples/commands/demo_calls.h"
#include "samples/page/html.h"

namespace limn {
namespace {

constexpr const char* kHead = R"(<!doctype html><html lang="en"><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>limn: demo</title>
<style>
  :root { color-scheme: light dark; }
  body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
  .grid { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 16rem), 1fr)); gap: 1.5rem 1rem; }
  figure { margin: 0; min-width: 0; }
  img { width: 100%; height: auto; aspect-ratio: 4 / 3; object-fit: contain; background: #fff; border-radius: .4rem; }
  code { display: block; font-size: .75rem; overflow-wrap: anywhere; opacity: .75; }
  a { color: inherit; }
</style>
<h1>The border of a surface, and how far to trust it</h1>
<p>A dark line is drawn where the surface turns away from the eye. Where it falls depends on how the surface is modelled: a formula, a
grid of distances, or triangles. Each comparison below draws one shape in every representation and counts the pixels where the border is
wrong. Below each picture stands the call that made it.</p>
)";

std::string figure(const DemoCall& call) {
  const std::string image = fmt::format(R"(<img src="{}" alt="{}" loading="lazy">)", escaped(call.picture.generic_string()),
                                        escaped(call.section + ": " + call.caption));
  const std::string caption = escaped(call.caption);
  const std::string linked = call.page.empty()
                                 ? image + "<figcaption>" + caption
                                 : fmt::format(R"(<a href="{}">{}</a><figcaption><a href="{}">{}: the report</a>)",
                                               escaped(call.page.generic_string()), image, escaped(call.page.generic_string()), caption);
  return fmt::format("<figure>{}<code>{}</code></figcaption></figure>\n", linked, escaped(shell_text(call)));
}

}  // namespace

std::string demo_page(const std::vector<DemoCall>& calls) {
  std::string text = kHead, section;
  for (const DemoCall& call : calls) {
    if (call.section != section) {
      if (!section.empty()) text += "</div>\n";
      section = call.section;
      text += fmt::format("<h2>{}</h2><div class=\"grid\">\n", escaped(section));
    }
    text += figure(call);
  }
  return text + "</div></html>\n";
}

}  // namespace limn
