// Writes JSON [RFC 8259]: one value, built front to back, with the commas and escapes in the right places.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pac::sim {

// JsonWriter json; json.begin_object(); json.field("bytes", 9836); json.end_object(); json.text()
// Numbers that JSON cannot hold (NaN, infinities) are written as null. The order of calls is the caller's
// responsibility: every begin_ has its end_, and inside an object every value follows a key().
class JsonWriter {
 public:
  void begin_object() { open('{'); }
  void end_object() { close('}'); }
  void begin_array() { open('['); }
  void end_array() { close(']'); }
  void key(std::string_view name);

  void value(std::string_view text);
  void value(const char* text) { value(std::string_view(text)); }
  void value(bool truth) { raw(truth ? "true" : "false"); }
  void value(double number);
  void value(int64_t number);
  void value(uint64_t number);
  void value(int number) { value(int64_t{number}); }
  void value(unsigned number) { value(uint64_t{number}); }
  void null() { raw("null"); }
  // As value(double), with `digits` digits after the point.
  void fixed(double number, int digits);

  template <class T>
  void field(std::string_view name, const T& content) {
    key(name);
    value(content);
  }
  void fixed_field(std::string_view name, double number, int digits) {
    key(name);
    fixed(number, digits);
  }
  void begin_object(std::string_view name) {
    key(name);
    begin_object();
  }
  void begin_array(std::string_view name) {
    key(name);
    begin_array();
  }

  const std::string& text() const { return text_; }

 private:
  void raw(std::string_view token);
  void open(char bracket);
  void close(char bracket);
  void separate();
  void newline();

  std::string text_;
  int depth_ = 0;
  bool first_ = true;       // nothing yet inside the innermost bracket
  bool after_key_ = false;  // the next value belongs to a key
};

// The text between quotes, escaped.
std::string json_escaped(std::string_view text);

}  // namespace pac::sim
