// What the objects that are selected have in common, in the groups in which it is shown.

import { titleOf } from "./kinds";
import type { AttributeFacts, AttributeFormat, SceneObject, Session } from "./session";

/** An attribute that each of some objects has. */
export interface SharedAttribute {
  /** The same for other objects. */
  key: string;
  /** For people. */
  name: string;
  format: AttributeFormat;
  objects: SceneObject[];
  /** Of each object. */
  facts: AttributeFacts[];
}

export interface AttributeGroup {
  /** The element of its attributes; empty: that of the object. */
  element: string;
  title: string;
  attributes: SharedAttribute[];
}

/** The path of an attribute without its object, which another object of the selection has too. */
const within = ({ path }: AttributeFacts, { name }: SceneObject) => path.slice(name.length + 1);

/** Names need not be unique in different elements; then they say where they stand. */
function nameOf(facts: AttributeFacts, object: SceneObject): string {
  const isUnique = object.attributes.every((each) => each === facts || each.name !== facts.name);
  if (isUnique || facts.element === object.kind) return facts.name;
  const path = within(facts, object);
  return path.includes(".") ? path.replaceAll(".", " ") : `${facts.element} ${facts.name}`;
}

/** With its name, which is no value. */
function attributesOf(session: Session, { name, kind, attributes }: SceneObject): AttributeFacts[] {
  const format = session.format.elements.find((each) => each.name === kind)?.attributes.find(({ type }) => type === "name");
  if (!format || attributes.some((each) => each.name === format.name && each.element === kind)) return attributes;
  return [{ name: format.name, element: kind, path: `${name}.${format.name}`, value: name, given: true, components: 0, animated: false }, ...attributes];
}

export function sharedAttributes(session: Session, objects: SceneObject[]): AttributeGroup[] {
  const [first, ...others] = objects;
  const groups: AttributeGroup[] = [];
  if (!first) return groups;
  const kinds = new Set(objects.map(({ kind }) => kind));
  const partsOf = others.map((object) => new Map(object.attributes.map((each) => [within(each, object), each])));
  for (const facts of attributesOf(session, first)) {
    const format = session.formatOf(facts);
    const same = partsOf.map((parts) => parts.get(within(facts, first)));
    const isSame = (other?: AttributeFacts): other is AttributeFacts => other !== undefined && session.formatOf(other)?.type === format?.type;
    if (!format || !same.every(isSame) || (others.length > 0 && format.type === "name")) continue;
    const element = facts.element === first.kind ? "" : facts.element;
    let group = groups.find((each) => each.element === element);
    if (!group) groups.push((group = { element, title: element ? titleOf(element) : kinds.size > 1 ? "In common" : titleOf(first.kind), attributes: [] }));
    group.attributes.push({ key: `${element} ${within(facts, first)}`, name: nameOf(facts, first), format, objects, facts: [facts, ...same] });
  }
  return groups;
}
