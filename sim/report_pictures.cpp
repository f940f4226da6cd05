#include "sim/report_pictures.h"

#include <algorithm>
#include <vector>

#include "sim/report_markup.h"

namespace pac::sim {
namespace {

using Text = std::string;

const char* arm_class(const ReportPicture& picture) {
  constexpr const char* kClasses[] = {"", "arm-image", "arm-polygon"};
  return kClasses[static_cast<size_t>(picture.arm)];
}

Text caption(const Text& label, const Text& title, const Text& numbers) {
  Text html = label.empty() ? "" : html_tag("span", "class=\"letter-tag\"", html_escaped(label));
  html += html_tag("b", "", html_escaped(title));
  if (!numbers.empty()) html += std::string(" ") + html_tag("span", "class=\"numbers\"", html_escaped(numbers));
  return html;
}

Text wipe_button(const ReportFigure& figure, const ReportPicture& picture, const char* side) {
  return html_tag("button",
                  std::string("type=\"button\" ") + html_attribute("data-wipe", figure.id + "-wipe") +
                      html_attribute("data-side", side) + html_attribute("data-id", picture.id) +
                      html_attribute("aria-label", "Show " + picture.title + " on the " + side + " of the wipe"),
                  Text(side));
}

// A window as large as a frame, behind which the film jumps on.
Text film_html(const ReportPicture& picture, const Text& image) {
  return html_tag("span",
                  "class=\"film\" style=\"--w:" + std::to_string(picture.width) +
                      ";--h:" + std::to_string(picture.height) + ";--frames:" + std::to_string(picture.frames) +
                      ";--rate:" + std::to_string(picture.frames_per_second) + "\"",
                  image);
}

Text picture_html(const ReportFigure& figure, const ReportPicture& picture) {
  const Text size = std::string("width=\"") + std::to_string(picture.width) + "\" height=\"" +
                    std::to_string(picture.height * picture.frames) + "\"";
  Text image =
      std::string("<img ") + html_attribute("src", picture.file) + html_attribute("alt", picture.alt) + size + ">";
  if (picture.frames > 1) image = film_html(picture, image);
  Text content = html_tag("a", html_attribute("href", picture.file), image) +
                 html_tag("figcaption", "", caption(picture.label, picture.title, picture.caption));
  if (!figure.wipe_left.empty())
    content += html_tag("div", "class=\"to-wipe\"",
                        wipe_button(figure, picture, "left") + wipe_button(figure, picture, "right"));
  return html_tag("figure", std::string("class=\"picture ") + Text(arm_class(picture)) + "\"", content) + "\n";
}

Text row_html(const ReportFigure& figure, const ReportRow& row) {
  Text pictures;
  int widest = 0;
  for (const ReportPicture& picture : row.pictures) {
    pictures += picture_html(figure, picture);
    widest = std::max(widest, picture.width);
  }
  const Text style = std::string("class=\"grid\" style=\"--columns:") + std::to_string(row.pictures.size()) +
                     ";--widest:" + std::to_string(widest) + "px\"";
  const Text label = row.label.empty() ? "" : html_tag("p", "class=\"label\"", html_escaped(row.label));
  return html_tag("div", "class=\"row\"", label + html_tag("div", style, "\n" + pictures)) + "\n";
}

Text picture_name(const ReportPicture& picture) {
  return (picture.label.empty() ? "" : picture.label + " · ") + picture.title;
}

std::vector<const ReportPicture*> pictures_of(const ReportFigure& figure) {
  std::vector<const ReportPicture*> pictures;
  for (const ReportRow& row : figure.rows)
    for (const ReportPicture& picture : row.pictures) pictures.push_back(&picture);
  return pictures;
}

const ReportPicture* find_picture(const ReportFigure& figure, const Text& id) {
  for (const ReportPicture* picture : pictures_of(figure))
    if (picture->id == id) return picture;
  return nullptr;
}

Text wipe_select(const ReportFigure& figure, const char* side, const Text& selected) {
  Text options;
  for (const ReportPicture* picture : pictures_of(figure))
    options += html_tag("option",
                        html_attribute("value", picture->id) + html_attribute("data-file", picture->file) +
                            html_attribute("data-alt", picture->alt) +
                            html_attribute("data-details", picture->caption + "\n" + picture->details) +
                            (picture->id == selected ? "selected" : ""),
                        html_escaped(picture_name(*picture))) +
               "\n";
  const Text id = figure.id + "-" + side;
  return html_tag("label", html_attribute("for", id), side[0] == 'l' ? "On the left" : "On the right") +
         html_tag("select", html_attribute("id", id) + html_attribute("class", side), "\n" + options);
}

Text wipe_side(const ReportFigure& figure, const char* side, const ReportPicture& picture) {
  return html_tag(
      "div", "class=\"side\"",
      wipe_select(figure, side, picture.id) + html_tag("p", Text("class=\"numbers ") + side + "\" aria-live=\"polite\"",
                                                       html_escaped(picture.caption + "\n" + picture.details)));
}

Text wipe_layer(const char* side, const ReportPicture& picture) {
  return html_tag("div", Text("class=\"layer ") + side + "\"",
                  std::string("<img ") + html_attribute("src", picture.file) + html_attribute("alt", picture.alt) +
                      "draggable=\"false\">");
}

Text wipe_tools() {
  Text html = html_tag("span", "", "Enlarge");
  for (const int zoom : {1, 2, 4, 8})
    html += html_tag("button", std::string("type=\"button\" data-zoom=\"") + std::to_string(zoom) + "\"",
                     std::to_string(zoom) + "×");
  html += html_tag("button", "type=\"button\" class=\"blink\" aria-pressed=\"false\"", "Blink");
  return html_tag("div", "class=\"tools\"", html);
}

Text wipe_attributes(const Text& id, const char* style, const ReportPicture& picture) {
  const Text width = std::to_string(picture.width), height = std::to_string(picture.height);
  return html_attribute("class", style) + html_attribute("id", id) + html_attribute("data-width", width) +
         "style=\"--w:" + width + ";--h:" + height + "\"";
}

// Both pictures, their names and the handle.
Text wipe_stage(const Text& where, const ReportPicture& left, const ReportPicture& right) {
  const Text handle = html_tag("div",
                               "class=\"handle\" role=\"slider\" tabindex=\"0\" " +
                                   html_attribute("aria-label", "Wipe between two pictures of " + where) +
                                   "aria-valuemin=\"0\" aria-valuemax=\"100\" aria-valuenow=\"50\"",
                               "");
  const auto name = [](const char* side, const ReportPicture& picture) {
    return html_tag("span", Text("class=\"tag ") + side + "\" aria-hidden=\"true\"",
                    html_escaped(picture_name(picture)));
  };
  return html_tag("div", "class=\"stage\"",
                  wipe_layer("right", right) + wipe_layer("left", left) + name("left", left) + name("right", right) +
                      handle) +
         "\n";
}

Text wipe_html(const ReportFigure& figure) {
  const ReportPicture* left = find_picture(figure, figure.wipe_left);
  const ReportPicture* right = find_picture(figure, figure.wipe_right);
  if (left == nullptr || right == nullptr) return "";
  constexpr const char* kHint =
      "Drag the handle, or focus it and use the arrow keys (<kbd>Shift</kbd> for larger steps), <kbd>+</kbd> and "
      "<kbd>−</kbd> to enlarge. Enlarged, drag the picture itself, or hold <kbd>Alt</kbd> with the arrow keys.";
  const Text panel = wipe_side(figure, "left", *left) + wipe_side(figure, "right", *right) + wipe_tools() +
                     html_tag("p", "class=\"hint\"", kHint);
  return html_tag(
             "div", wipe_attributes(figure.id + "-wipe", "wipe", *left),
             std::string("\n") + wipe_stage(figure.number, *left, *right) + html_tag("div", "class=\"panel\"", panel)) +
         "\n";
}

Text percent(double part, double whole) {
  return decimal_text(100 * part / whole, 4) + "%";
}

Text crop_html(const ReportFigure& figure, const ReportCrop& crop) {
  const ReportPicture* picture = find_picture(figure, crop.picture_id);
  if (picture == nullptr || crop.width <= 0 || crop.height <= 0) return "";
  const Text place = std::string("width:") + percent(picture->width, crop.width) +
                     ";left:" + percent(-crop.x, crop.width) + ";top:" + percent(-crop.y, crop.height);
  const Text image = std::string("<img ") + html_attribute("src", picture->file) +
                     html_attribute("alt", "Enlarged part of: " + picture->alt) + "style=\"" + place + "\">";
  const Text frame = html_tag("div",
                              std::string("class=\"crop\" style=\"aspect-ratio:") + std::to_string(crop.width) + "/" +
                                  std::to_string(crop.height) + "\"",
                              image);
  return html_tag("figure", std::string("class=\"") + Text(arm_class(*picture)) + "\"",
                  frame + html_tag("figcaption", "", caption(picture->label, picture->title, crop.caption))) +
         "\n";
}

Text crops_html(const ReportFigure& figure) {
  if (figure.crops.empty()) return "";
  Text crops;
  for (const ReportCrop& crop : figure.crops) crops += crop_html(figure, crop);
  return html_tag("h3", "", "Enlarged") + html_tag("div", "class=\"grid crops\"", "\n" + crops);
}

}  // namespace

std::string figure_pictures(const ReportFigure& figure) {
  Text html;
  for (size_t i = 0; i < figure.rows.size(); ++i) {
    html += row_html(figure, figure.rows[i]);
    if (i == 0) html += wipe_html(figure);
  }
  return html + crops_html(figure);
}

std::string head_wipe(const ReportFigure& figure) {
  const ReportPicture* left = find_picture(figure, figure.wipe_left);
  const ReportPicture* right = find_picture(figure, figure.wipe_right);
  if (left == nullptr || right == nullptr) return "";
  return html_tag("div", wipe_attributes("head-wipe", "wipe compact", *left),
                  std::string("\n") + wipe_stage(figure.number + ", at the head of the page", *left, *right)) +
         "\n";
}

}  // namespace pac::sim
