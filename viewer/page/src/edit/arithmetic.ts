// Arithmetic as people type it into number fields.

import jsep, { type BinaryExpression, type Expression, type Literal, type UnaryExpression } from "jsep";

jsep.removeAllBinaryOps();
jsep.removeAllUnaryOps();
jsep.removeAllLiterals();
for (const sign of ["+", "-"]) {
  jsep.addUnaryOp(sign);
  jsep.addBinaryOp(sign, 1);
}
for (const sign of ["*", "/"]) jsep.addBinaryOp(sign, 2);

const plainNumber = /^-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;
const operators: Record<string, (left: number, right: number) => number> = {
  "+": (left, right) => left + right,
  "-": (left, right) => left - right,
  "*": (left, right) => left * right,
  "/": (left, right) => left / right,
};

/** The value of a number or of arithmetic of + - * / ( ). NaN: it is neither. */
export function evaluated(text: string): number {
  try {
    return valueOf(jsep(text));
  } catch {
    return NaN;
  }
}

/** The number to send for what was typed. What is no arithmetic goes as it is, and the command judges it. */
export function numberTyped(text: string): string {
  if (plainNumber.test(text)) return text;
  const value = evaluated(text);
  return Number.isFinite(value) ? String(Number(value.toPrecision(15))) : text;
}

function valueOf(expression: Expression): number {
  if (isLiteral(expression)) return typeof expression.value === "number" ? expression.value : NaN;
  if (isUnary(expression)) return expression.operator === "-" ? -valueOf(expression.argument) : valueOf(expression.argument);
  if (isBinary(expression)) return operators[expression.operator](valueOf(expression.left), valueOf(expression.right));
  return NaN;
}

const isLiteral = (expression: Expression): expression is Literal => expression.type === "Literal";
const isUnary = (expression: Expression): expression is UnaryExpression => expression.type === "UnaryExpression";
const isBinary = (expression: Expression): expression is BinaryExpression => expression.type === "BinaryExpression";

/** The decimal place of a tenth of what a pixel shows. */
export function stepOf(perPixel: number): number {
  return 10 ** Math.floor(Math.log10(Math.max(perPixel, 1e-300) / 10) + 1e-9);
}

/** The significant digits with which the largest of some numbers ends at that place. */
export function digitsTo(step: number, ...numbers: number[]): number {
  const size = Math.max(...numbers.map(Math.abs), step);
  return Math.min(Math.floor(Math.log10(size)) - Math.round(Math.log10(step)) + 1, 17);
}

/** The decimal place at which a number ends. */
export function placeOf(value: number): number {
  const [digits, exponent] = String(value).split("e");
  return 10 ** (Number(exponent ?? 0) - (digits.split(".")[1] ?? "").length);
}

/** A number as short as its decimal place allows. */
export function rounded(value: number, step: number): string {
  const digits = Math.round(-Math.log10(step));
  return String(digits > 0 ? Number(value.toFixed(Math.min(digits, 100))) + 0 : Math.round(value / step) * step + 0);
}
