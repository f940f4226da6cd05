#include "tests/support/json_check.h"

#include <cctype>

namespace pac::test {
namespace {

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  bool read() {
    value("");
    skip_space();
    return ok_ && at_ == text_.size();
  }
  std::map<std::string, std::string> leaves;

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void skip_space() {
    while (peek() == ' ' || peek() == '\n' || peek() == '\t' || peek() == '\r') ++at_;
  }
  bool take(char c) {
    skip_space();
    if (peek() != c) return false;
    ++at_;
    return true;
  }
  void expect(char c) { ok_ = take(c) && ok_; }

  std::string string() {
    std::string out;
    expect('"');
    while (ok_ && peek() != '"') {
      if (at_ >= text_.size() || static_cast<unsigned char>(peek()) < 0x20) ok_ = false;
      if (peek() == '\\') {
        ++at_;
        ok_ = ok_ && std::string("\"\\/bfnrtu").find(peek()) != std::string::npos;
      }
      out += peek();
      ++at_;
    }
    ++at_;
    return out;
  }

  void value(const std::string& path) {
    if (!ok_) return;
    skip_space();
    if (peek() == '{') return object(path);
    if (peek() == '[') return array(path);
    if (peek() == '"') {
      leaves[path] = string();
      return;
    }
    const size_t start = at_;
    while (std::isalnum(static_cast<unsigned char>(peek())) != 0 ||
           std::string("+-.").find(peek()) != std::string::npos)
      if (peek() == '\0')
        break;
      else
        ++at_;
    const std::string word = text_.substr(start, at_ - start);
    ok_ = is_number(word) || word == "true" || word == "false" || word == "null";
    leaves[path] = word;
  }

  static bool is_number(const std::string& word) {
    if (word.empty() || word.find_first_not_of("+-.eE0123456789") != std::string::npos) return false;
    const size_t digit = word[0] == '-' ? 1 : 0;
    if (digit >= word.size() || std::isdigit(static_cast<unsigned char>(word[digit])) == 0) return false;
    return !(word[digit] == '0' && word.size() > digit + 1 &&
             std::isdigit(static_cast<unsigned char>(word[digit + 1])) != 0);
  }

  void object(const std::string& path) {
    expect('{');
    if (take('}')) return;
    do {
      skip_space();
      const std::string key = string();
      expect(':');
      value(path.empty() ? key : path + "." + key);
    } while (ok_ && take(','));
    expect('}');
  }

  void array(const std::string& path) {
    expect('[');
    if (take(']')) return;
    int index = 0;
    do value(path + "[" + std::to_string(index++) + "]");
    while (ok_ && take(','));
    expect(']');
  }

  const std::string& text_;
  size_t at_ = 0;
  bool ok_ = true;
};

}  // namespace

std::optional<std::map<std::string, std::string>> json_leaves(const std::string& text) {
  Reader reader(text);
  if (!reader.read()) return std::nullopt;
  return reader.leaves;
}

}  // namespace pac::test
