#include "tools/kept/value.h"

#include "engine/core/error.h"

#include <nlohmann/json.hpp>

namespace lambent {

namespace {

using Json = nlohmann::json;

constexpr int kMostNesting = 200; // as engine/scene/json_text.cpp

Json jsonOf(const Value& value) {
  if (value.isNothing()) return {};
  if (value.isText()) return value.text();
  Json out = value.isList() ? Json::array() : Json::object();
  for (const Value& v : value.items()) out.push_back(jsonOf(v));
  for (const auto& [name, v] : value.fields()) out[name] = jsonOf(v);
  if (value.isList() || value.isObject()) return out;
  if (value.isBool()) return value.whole() != 0;
  if (value.isWhole()) return value.whole();
  return value.number();
}

Value valueOf(const Json& json) {
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_number_float()) return json.get<double>();
  if (json.is_number()) return json.get<long>();
  if (json.is_string()) return json.get<std::string>();
  Value out = json.is_array() ? Value::list() : json.is_object() ? Value::of() : Value();
  for (const auto& [name, value] : json.items()) (json.is_array() ? out.add({}) : out[name]) = valueOf(value);
  return out;
}

} // namespace

Value::Value() = default;
Value::Value(const Value&) = default;
Value::Value(Value&&) noexcept = default;
Value& Value::operator=(const Value&) = default;
Value& Value::operator=(Value&&) noexcept = default;
Value::~Value() = default;
Value::Value(double n) : kind_(Real), real_(n) {}
Value::Value(std::optional<double> n) : kind_(n ? Real : Nothing), real_(n.value_or(0)) {}
Value::Value(const char* text) : kind_(Text), text_(text) {}
Value::Value(std::string text) : kind_(Text), text_(std::move(text)) {}
Value::Value(List list) : kind_(Several), list_(std::move(list)) {}

Value Value::ofPairs(std::initializer_list<Value> pairs) {
  Value out;
  out.kind_ = Object;
  for (const Value* name = pairs.begin(); name != pairs.end(); name += 2) out[name->text()] = name[1];
  return out;
}

Value Value::parsed(const std::string& text) {
  bool deep = false; // valueOf would run out of stack
  const auto keep = [&](int depth, Json::parse_event_t, Json&) { return !(deep |= depth > kMostNesting); };
  const Json json = Json::parse(text, keep, false);
  return deep || json.is_discarded() ? Value() : valueOf(json);
}

std::string Value::json(int indentation) const {
  return jsonOf(*this).dump(indentation, ' ', false, Json::error_handler_t::replace);
}

double Value::number() const {
  if (!isNumber()) throw RunError("a figure that should be a number is none (a file of an earlier run was changed)");
  return kind_ == Real ? real_ : double(whole_);
}

std::vector<double> Value::numbers() const {
  std::vector<double> out;
  for (const Value& v : list_) out.push_back(v.number());
  return out;
}

Value& Value::add(Value value) {
  CHECK(isNothing() || isList());
  kind_ = Several;
  return list_.emplace_back(std::move(value));
}

Value& Value::operator[](const std::string& name) {
  CHECK(isNothing() || isObject());
  kind_ = Object;
  return fields_[name];
}

double Value::numberOr(const std::string& name, double otherwise) const {
  return has(name) && (*this)[name].isNumber() ? (*this)[name].number() : otherwise;
}

void Value::update(const Value& other) {
  for (const auto& [name, value] : other.fields_) (*this)[name] = value;
}

} // namespace lambent
