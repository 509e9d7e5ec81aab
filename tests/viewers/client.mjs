// Reads everything that a view serves with the client that the protocol's makers publish, decodes it by the schemas that come with it,
// and tells what was seen as JSON: node client.mjs URL
import rosmsg from '@foxglove/rosmsg';
import serialization from '@foxglove/rosmsg2-serialization';
import protocol from '@foxglove/ws-protocol';
import WebSocket from 'ws';

const [, , url] = process.argv;
// Of each topic so many messages are decoded; waiting ends after so long [ms].
const ENOUGH = 20, PATIENCE = 60000;

const seen = { server: null, topics: {}, parameters: [], set: [], services: {}, statuses: [], times: 0, errors: [] };
const socket = new WebSocket(url, [protocol.FoxgloveClient.SUPPORTED_SUBPROTOCOL]);
const client = new protocol.FoxgloveClient({ ws: socket });
const fail = (what) => (error) => seen.errors.push(`${what}: ${error?.message ?? error}`);
client.on('error', fail('the client'));
client.on('status', (status) => seen.statuses.push(status.message));
client.on('serverInfo', (info) => { seen.server = info; });
client.on('time', () => { seen.times++; });

const readers = new Map();
client.on('advertise', (channels) => {
  for (const channel of channels) {
    const { topic, encoding, schemaName, schemaEncoding, schema } = channel;
    seen.topics[topic] = { encoding, schemaName, schemaEncoding, messages: 0, last: null };
    let read;
    try {
      if (encoding === 'cdr') {
        const reader = new serialization.MessageReader(rosmsg.parse(schema, { ros2: true }));
        read = (data) => reader.readMessage(data);
      } else {
        read = (data) => JSON.parse(new TextDecoder().decode(data));
      }
    } catch (error) { fail(topic)(error); continue; }
    readers.set(client.subscribe(channel.id), { topic, read });
  }
});
client.on('message', ({ subscriptionId, data }) => {
  const { topic, read } = readers.get(subscriptionId) ?? {};
  const about = seen.topics[topic];
  if (!about || about.messages >= ENOUGH) return;
  try { about.last = read(data); about.messages++; } catch (error) { fail(topic)(error); readers.delete(subscriptionId); }
});

const asked = new Map();
client.on('parameterValues', ({ parameters, id }) => {
  if (id === 'all') seen.parameters = parameters;
  if (id === 'set') seen.set = parameters;
});
client.on('advertiseServices', (services) => {
  for (const service of services) seen.services[service.name] = { ...service, answer: null };
});
client.on('serviceCallResponse', (answer) => {
  seen.services[asked.get(answer.callId)].answer = JSON.parse(new TextDecoder().decode(answer.data));
});
client.on('serviceCallFailure', (failure) => { seen.services[asked.get(failure.callId)].answer = { failed: failure.message }; });

const until = async (what, done) => {
  const end = Date.now() + PATIENCE;
  while (!done()) {
    if (Date.now() > end) { seen.errors.push(`never came: ${what}`); return; }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
};
await until('the server', () => seen.server && Object.keys(seen.topics).length);
const loop = ['/joint_states', '/rig_measurement', '/reference', '/motor_voltage', '/friction_estimate', '/controller_state'];
await until('the topics of the loop', () => loop.every((topic) => seen.topics[topic]?.messages >= ENOUGH));
await until('the parameters', () => {
  // The nodes are found one after the other.
  const ofNode = (node) => seen.parameters.filter(({ name }) => name.startsWith(node)).length;
  const all = ['/rig_driver.', '/friction_observer.', '/controller.'].every((node) => ofNode(node) > 5);
  if (!all) client.getParameters([], 'all');
  return all && seen.parameters.length > 50;
});
// One is set to what it is.
client.setParameters([seen.parameters.find(({ name }) => name.endsWith('.reference_timeout'))].filter(Boolean), 'set');
await until('the parameter that was set', () => seen.set.length);
// Services that only read.
const reads = (name) => /\/(get_state|list_experiments)$/.test(name);
await until('the services', () => Object.keys(seen.services).some(reads));
let call = 0;
for (const { id, name } of Object.values(seen.services).filter(({ name }) => reads(name))) {
  asked.set(++call, name);
  client.sendServiceCallRequest({ serviceId: id, callId: call, encoding: 'json', data: new TextEncoder().encode('{}') });
}
await until('the answers', () => Object.values(seen.services).every(({ name, answer }) => answer || !reads(name)));
client.close();
const plain = (_, value) => (typeof value === 'bigint' ? Number(value) : ArrayBuffer.isView(value) ? [...value] : value);
process.stdout.write(JSON.stringify(seen, plain), () => process.exit(0));
