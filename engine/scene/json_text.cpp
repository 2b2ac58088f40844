#include "engine/scene/json_text.h"

#include "engine/core/error.h"

#include <deque>
#include <unordered_set>

#include <nlohmann/json.hpp>

namespace lambent {

namespace {

constexpr size_t kMaxNesting = 200; // real files nest about ten deep

/// A string as parsers have it.
std::string unescaped(std::string_view inside) {
  const nlohmann::json text = nlohmann::json::parse('"' + std::string(inside) + '"', nullptr, false);
  return text.is_string() ? text.get<std::string>() : std::string(inside); // what is none is left to the parser
}

bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

} // namespace

JsonText checkJson(const std::filesystem::path& file, std::string_view text) {
  JsonText out;
  std::vector<std::unordered_set<std::string_view>> open; // keys of the objects (of lists: none) around
  std::deque<std::string> written;                        // of keys that are written with escapes
  std::string_view key, outermost; // the latter: of the outermost object
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const size_t begin = i + 1;
      for (++i; i < text.size() && text[i] != '"'; ++i)
        if (text[i] == '\\') ++i;
      const std::string_view inside = text.substr(begin, std::min(i, text.size()) - begin);
      size_t next = i + 1;
      while (next < text.size() && isSpace(text[next])) ++next;
      if (next < text.size() && text[next] == ':') {
        key = inside.find('\\') == inside.npos ? inside : written.emplace_back(unescaped(inside));
        if (!open.empty() && !open.back().insert(key).second)
          throw InputError(file.string(),
                           "gives the key '" + std::string(key) + "' twice in one object (once expected)");
        if (open.size() == 1) outermost = key;
        do ++next;
        while (next < text.size() && isSpace(text[next]));
        if (key == "byteStride" && next < text.size() && text[next] == '-')
          throw InputError(file.string(), "gives a byteStride below 0 (4 to 252 expected)"); // taken for none
      } else if (key == "uri" && !inside.starts_with("data:")) {
        out.uris.push_back(unescaped(inside));
      }
    } else if (c == '[' || c == '{') {
      if (c == '{' && open.size() == 2 && outermost == "materials") ++out.materials;
      if (c == '{' && open.size() == 2 && (outermost == "samplers" || outermost == "textures" || outermost == "images"))
        ++out.textureParts;
      if (open.size() >= kMaxNesting)
        throw InputError(file.string(), "the JSON is nested more than " + std::to_string(kMaxNesting) + " levels deep");
      open.emplace_back();
    } else if ((c == ']' || c == '}') && !open.empty()) {
      open.pop_back();
    }
  }
  return out;
}

std::string reasonOf(std::string message) {
  message = message.substr(0, message.find("; last read")); // what somebody's file holds is nobody's
  const size_t end = message.find("] ");
  return message.starts_with("[json.exception.") && end != message.npos ? message.substr(end + 2) : message;
}

} // namespace lambent
